#pragma once
/// Options and cells that both tables share.

#include <memory>
#include <string>
#include <vector>

#include "apps/common/named_scenes.hpp"
#include "apps/common/text_table.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/simulation.hpp"

namespace CLI {
class App;
}

namespace apps {

/// Options of both tables, as typed.
struct TableOptions {
  std::string scene = "all";
  std::string n_star = "32k";    ///< one, or several separated by commas
  std::string preset = "tuned";  ///< tuned, paper or both
  std::string tau = "fixed:-6";  ///< live, fixed:X or table2
  std::string backend = "auto";
  std::string csv, markdown, svg_folder;
};
void add_table_options(CLI::App& command, TableOptions& options);

struct CellSize {
  std::string word;
  std::int64_t n_star = 0;
};
std::vector<CellSize> sizes_of(const std::string& words);
std::vector<sim::Preset> presets_of(const std::string& word);

/// The tau of temporal acceleration; none = measured live.
std::optional<double> tau_of(const std::string& word, const std::string& scene, const std::string& n_star,
                             sim::MethodKind method);

/// Reads the model of a PTPE file and prints a line about it; the paper's model if `path` is empty.
stats::PtpeModel load_model(const std::string& path);
inline constexpr const char* ptpe_help =
    "fitted.toml of vip-stats fit-ptpe, by which tau and beta go; without: the paper's model";

}  // namespace apps
