#pragma once

#include <CLI/CLI.hpp>

namespace apps {

/// vip-bench frame: milliseconds a frame of one scene and method, with the accuracy that they buy.
void add_frame_command(CLI::App& app);

}  // namespace apps
