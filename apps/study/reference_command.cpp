/// vip-study reference: lists every key of a protocol file.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "apps/study/commands.hpp"
#include "libstudy/protocol/reference.hpp"

namespace apps {

void add_reference_command(CLI::App& app) {
  app.add_subcommand("reference", "Print every key of a protocol file, as Markdown")->callback([] {
    std::fputs(study::protocol_reference_page().c_str(), stdout);
  });
}

}  // namespace apps
