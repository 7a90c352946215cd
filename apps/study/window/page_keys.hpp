#pragma once
/// What keys mean on a participant's page; keys as GLFW numbers them.

#include "apps/study/pages/page_surface.hpp"

namespace apps {

/// What a key that was pressed means.
PageEvent event_of(int key, bool shift);

}  // namespace apps
