#pragma once
/// Looks up the scenes of the paper's tables by name.

#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"

namespace sim {

struct CellScene {
  std::string name;  ///< name in the paper's tables, such as SingleDam
  Scene scene;
};
/// One scene by name, or "all". base::Error, naming the known scenes, for any other word.
std::vector<CellScene> scenes_of(const std::string& word);

}  // namespace sim
