/// vip-study push and pull: exchange with the central database of a lab.
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/database_place.hpp"
#include "libstudy/store/push/push.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

struct PushCommand {
  std::string database, service;
  bool yes = false;
};

long long count(std::int64_t number) { return static_cast<long long>(number); }

void push(const PushCommand& command) {
  const bool shows = ::isatty(STDERR_FILENO) == 1;
  const auto tell = [&](std::int64_t done, std::int64_t all) {
    if (shows) std::fprintf(stderr, "\rsession %lld of %lld ", count(done + 1), count(all));
  };
  const study::Push done = study::push(command.database, command.service, tell);
  if (shows) std::fprintf(stderr, "\r\x1b[K");
  std::printf("%s: %lld sessions, %lld sent: %lld rows, %lld bytes\n", command.service.c_str(),
              count(done.sessions), count(done.sent), count(done.rows), count(done.bytes));
  if (done.tombstones > 0) std::printf("%lld withdrawals sent\n", count(done.tombstones));
  if (done.older > 0)
    std::printf("%lld sessions left as they are: the centre has a later state of them\n", count(done.older));
  if (done.withdrawn > 0)
    std::printf("%lld sessions left out: their people withdrew; vip-study pull withdraws them here\n",
                count(done.withdrawn));
  return_slots_after_push(command.database, command.service);
  print_list("Not taken:", done.refused);
  if (!done.refused.empty()) {
    throw base::Error(
        "service " + command.service,
        "did not take " + std::to_string(done.refused.size()) + " sessions; the others are there",
        "see above why; mend that and push again");
  }
}

/// Asks whether to delete these people, because the deletion is final.
void confirm_pull(const PushCommand& command, const std::vector<std::string>& codes) {
  if (command.yes) return;
  std::string typed;
  if (::isatty(STDIN_FILENO) == 1) {
    std::printf("All their data in %s will be deleted for good. Type yes to go on: ",
                command.database.c_str());
    std::fflush(stdout);
    std::getline(std::cin, typed);
  }
  if (typed != "yes") {
    throw base::Error(
        "pull",
        "the withdrawal of " + std::to_string(codes.size()) + " people is not confirmed; nothing was deleted",
        "run it in a terminal and type yes when asked, or give --yes");
  }
}

void pull(const PushCommand& command) {
  study::warn_of_place(command.database);
  const auto codes = study::withdrawn_at_centre(command.database, command.service);
  if (codes.empty()) {
    std::printf("%s: nobody of %s withdrew elsewhere\n", command.service.c_str(), command.database.c_str());
    return;
  }
  print_list("Withdrew elsewhere:", codes);
  confirm_pull(command, codes);
  for (const std::string& code : codes) withdraw_and_tell(command.database, code);
}

}  // namespace

void add_push_command(CLI::App& app) {
  auto command = std::make_shared<PushCommand>();
  CLI::App& sub = *app.add_subcommand("push", "Send what is new to the central database of a lab");
  add_database(sub, command->database);
  add_service(sub, "--to", command->service, "Service of the central database");
  sub.footer(
      "Sends withdrawals first, then sessions in the order of planning. It may be cut off at any moment: "
      "what\n"
      "was committed stays, and the next push goes on. The personal file and exports are never sent.");
  sub.callback([command] { push(*command); });
}

void add_pull_command(CLI::App& app) {
  auto command = std::make_shared<PushCommand>();
  CLI::App& sub = *app.add_subcommand("pull", "Withdraw here who withdrew at another station");
  add_database(sub, command->database);
  add_service(sub, "--from", command->service, "Service of the central database");
  sub.add_flag("--yes", command->yes, "Do not ask");
  sub.footer("Deletes each of these people as vip-study withdraw does.");
  sub.callback([command] { pull(*command); });
}

}  // namespace apps
