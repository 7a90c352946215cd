#pragma once
/// Options that vip-bench table1 and table2 share.

#include <string>

#include "libsim/measure/cells.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace CLI {
class App;
}

namespace apps {

void add_table_options(CLI::App& command, measure::TableOptions& options);

/// Reads the model of a PTPE file and prints a line about the file. Returns the paper's model if `path` is
/// empty.
stats::PtpeModel load_model(const std::string& path);
inline constexpr const char* ptpe_help =
    "fitted.toml of vip-stats fit-ptpe, by which tau and beta go; without: the paper's model";

}  // namespace apps
