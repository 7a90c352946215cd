#pragma once
/// Reference of all keys of a scene file. A test compares it with the keys that the readers ask for.

#include <string>
#include <vector>

#include "stats/base/key_reference.hpp"

namespace sim {

/// The keys of [[effect]] stand in a table for each kind: "effect.foam".
const std::vector<base::KeyReference>& scene_reference();

/// The reference as a page of Markdown: docs/scenes.md.
std::string scene_reference_page();

}  // namespace sim
