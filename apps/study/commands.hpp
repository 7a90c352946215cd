#pragma once
/// The commands of vip-study: each in a file of its own, each adds itself to the program.

#include <CLI/CLI.hpp>

namespace apps {

void add_check_command(CLI::App& app);

}  // namespace apps
