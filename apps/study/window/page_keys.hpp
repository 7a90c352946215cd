#pragma once
/// What keys mean on a participant's page; keys as GLFW numbers them.

#include <optional>

#include "apps/study/desk/page.hpp"

namespace apps {

/// 0 to 9, of either block of digits; -1: another key.
int digit_of(int key);
/// None: a key without a meaning on a page.
std::optional<PageKey> page_key(int key, bool shift);
/// Lines that a key scrolls down; 0: it scrolls nothing.
float lines_of(int key);

}  // namespace apps
