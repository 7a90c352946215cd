/// vip-study withdraw: deletes a participant's data.
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/database_place.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

struct WithdrawCommand {
  std::string participant, database;
  bool yes = false;
};

/// Asks the user to type the participant's code again, because the deletion is final. base::Error if the code
/// differs.
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
                      "run it in a terminal and type the code when asked, or give --yes");
  }
}

void withdraw(const WithdrawCommand& command) {
  study::warn_of_place(command.database);
  confirm(command);
  withdraw_and_tell(command.database, command.participant);
}

}  // namespace

void add_withdraw_command(CLI::App& app) {
  auto command = std::make_shared<WithdrawCommand>();
  CLI::App& sub = *app.add_subcommand("withdraw", "Delete a participant's data, for good");
  sub.add_option("participant", command->participant, "Code of the participant")->required();
  add_database(sub, command->database);
  sub.add_flag("--yes", command->yes, "Do not ask");
  sub.footer(
      "Deletes the participant from the database and its log, its backups and the file of personal data. "
      "Deletes\nwhole each export and report that was made from it and holds the participant: make those "
      "again. What cannot\nbe deleted is listed, and the exit status is then 1; repeat the command when the "
      "cause is fixed.");
  sub.callback([command] { withdraw(*command); });
}

}  // namespace apps
