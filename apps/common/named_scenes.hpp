#pragma once
/// The scenes of the paper's tables by their names.

#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"

namespace apps {

struct CellScene {
  std::string name;  ///< as in the paper's tables
  sim::Scene scene;
};
/// base::Error naming the known scenes.
std::vector<CellScene> scenes_of(const std::string& word);

}  // namespace apps
