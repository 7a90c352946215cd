#pragma once
/// Reference of all keys of a scene file. A test compares it with the keys that the readers read.

#include <string>
#include <vector>

#include "stats/base/key_reference.hpp"

namespace sim {

/// All keys, table by table. Each kind of [[effect]] has a table of its own, such as "effect.foam".
const std::vector<base::KeyReference>& scene_reference();

/// The reference as a page of Markdown: docs/scenes.md.
std::string scene_reference_page();

}  // namespace sim
