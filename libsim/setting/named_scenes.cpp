#include "libsim/setting/named_scenes.hpp"

#include "stats/base/error.hpp"

namespace sim {

namespace {

struct NamedScene {
  const char* name;
  const char* file;
};
constexpr NamedScene named_scenes[] = {{"SingleDam", "data/scenes/single_dam.toml"},
                                       {"JetImpact", "data/scenes/jet_impact.toml"},
                                       {"Faucet", "data/scenes/faucet.toml"}};

}  // namespace

std::vector<CellScene> scenes_of(const std::string& word) {
  std::vector<CellScene> out;
  for (const auto& [name, file] : named_scenes) {
    if (word == "all" || word == name) out.push_back({name, read_scene(file)});
  }
  if (out.empty()) {
    throw base::Error("--scene " + word, "is not a scene of the paper's tables",
                      "use all, SingleDam, JetImpact or Faucet");
  }
  return out;
}

}  // namespace sim
