#pragma once
/// Meaning of keys on a participant's page, by GLFW key numbers.

#include "libstudy/pages/gui/page_surface.hpp"

namespace study {

/// The event of a pressed key.
PageEvent event_of(int key, bool shift);

}  // namespace study
