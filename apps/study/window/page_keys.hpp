#pragma once
/// Meaning of keys on a participant's page, by GLFW key numbers.

#include "apps/study/pages/page_surface.hpp"

namespace apps {

/// The event of a pressed key.
PageEvent event_of(int key, bool shift);

}  // namespace apps
