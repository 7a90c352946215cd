#pragma once
/// Options of the commands for the paper's Tables 1 and 2, and the sizes, presets and tau that they select.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libsim/methods/preset.hpp"
#include "libsim/setting/named_scenes.hpp"
#include "libsim/simulation.hpp"
#include "stats/figures/text_table.hpp"

namespace measure {

/// Options that `vip-bench table1` and `vip-bench table2` share, as typed.
struct TableOptions {
  std::string scene = "all";
  std::string n_star = "32k";    ///< one, or several separated by commas
  std::string preset = "tuned";  ///< tuned, paper or both
  std::string tau = "fixed:-6";  ///< live, fixed:X or table2
  std::string backend = "auto";
  std::string csv, markdown, svg_folder;
};

struct CellSize {
  std::string word;
  std::int64_t n_star = 0;
};
std::vector<CellSize> sizes_of(const std::string& words);
std::vector<sim::Preset> presets_of(const std::string& word);

/// The tolerance tau, frames/s, that the option --tau selects for this scene, n_* and method; none if tau
/// follows from the measured frame times.
std::optional<double> tau_of(const std::string& word, const std::string& scene, const std::string& n_star,
                             sim::MethodKind method);

}  // namespace measure
