/// vip-study withdraw: a participant takes the data back.
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "apps/study/commands.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

struct WithdrawCommand {
  std::string participant, database;
  bool yes = false;
};

/// Nothing brings the data back, so the code is asked for once more.
void confirm(const WithdrawCommand& command) {
  if (command.yes) return;
  std::string typed;
  if (::isatty(STDIN_FILENO) == 1) {
    std::printf("All data of %s in %s will be deleted for good. Type the code again to go on: ",
                command.participant.c_str(), command.database.c_str());
    std::fflush(stdout);
    std::getline(std::cin, typed);
  }
  if (typed != command.participant) {
    throw base::Error("withdraw " + command.participant, "is not confirmed; nothing was deleted",
                      "type the code when asked, or give --yes");
  }
}

void print_list(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  std::printf("%s\n", title);
  for (const std::string& line : lines) std::printf("  %s\n", line.c_str());
}

void withdraw(const WithdrawCommand& command) {
  confirm(command);
  const study::Withdrawal done = study::withdraw(command.database, command.participant);
  std::printf("%s: %lld sessions, %lld answers and %lld frames of %s deleted\n", command.database.c_str(),
              static_cast<long long>(done.sessions), static_cast<long long>(done.answers),
              static_cast<long long>(done.frames), command.participant.c_str());
  for (const auto& path : done.scrubbed) std::printf("cleaned as well: %s\n", path.c_str());
  print_list("Exports are out of reach. Delete these and what was copied from them:", done.exports);
  print_list("Recorded at these stations: withdraw in their own databases, or merge this one into them:",
             done.stations);
  print_list("Backups that could not be cleaned; delete them:", done.failed);
}

}  // namespace

void add_withdraw_command(CLI::App& app) {
  auto command = std::make_shared<WithdrawCommand>();
  CLI::App& sub = *app.add_subcommand("withdraw", "Delete a participant's data, for good");
  sub.add_option("participant", command->participant, "Code of the participant")->required();
  sub.add_option("--db", command->database, "Database of the study")->required();
  sub.add_flag("--yes", command->yes, "Do not ask");
  sub.callback([command] { withdraw(*command); });
}

}  // namespace apps
