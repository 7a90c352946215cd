/// vip-study consent: shows and changes a participant's permissions.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/permissions.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct ConsentCommand {
  std::string participant, database, gaze, sharing;
  bool incomplete = false;
};

std::optional<bool> permission_of(const std::string& word) {
  if (word.empty()) return {};
  return word == "yes";
}

const char* word_of(const std::optional<bool>& granted) {
  if (!granted) return "not asked";
  return *granted ? "yes" : "no";
}

constexpr const char* backups_title = "Backups that still hold gaze; delete them:";
constexpr const char* exports_title =
    "Exports that may hold gaze; delete them and their copies, or make them again:";

void print_change(const ConsentCommand& command) {
  const study::PermissionChange done = study::change_permissions(
      command.database, command.participant, {permission_of(command.gaze), permission_of(command.sharing)});
  if (command.gaze == "no")
    std::printf("%lld samples of gaze deleted\n", static_cast<long long>(done.gaze_deleted));
  print_list(backups_title, done.backups);
  print_list(exports_title, done.gaze_exports);
  print_list("Public exports that hold the participant; delete them and their copies, or make them again:",
             done.exports);
  print_list("Could not be cleaned:", done.left);
  study::check_nothing_left(command.database, done.left);
  if (!done.backups.empty()) {
    throw base::Error(command.database, "has backups that still hold gaze of " + command.participant,
                      "delete the files listed and run the command again");
  }
}

void consent(const ConsentCommand& command) {
  const bool changed = !command.gaze.empty() || !command.sharing.empty();
  if (changed) print_change(command);
  if (command.incomplete) print_lacking(command.database, study::lacking_of(command.database));
  bool refused = false;
  for (const auto& session :
       study::read_permissions({command.database, command.incomplete}, command.participant)) {
    std::printf("%s %s visit %d: gaze kept %s, data shared %s\n", command.participant.c_str(),
                base::shortened(session.protocol).c_str(), session.visit, word_of(session.gaze),
                word_of(session.sharing));
    refused = refused || session.gaze == false;
  }
  if (changed || !refused) return;
  const auto elsewhere =
      study::find_gaze_elsewhere({command.database, command.incomplete}, command.participant);
  print_list(backups_title, elsewhere.backups);
  print_list(exports_title, elsewhere.exports);
}

}  // namespace

void add_consent_command(CLI::App& app) {
  auto command = std::make_shared<ConsentCommand>();
  CLI::App& sub = *app.add_subcommand("consent", "Show or change what a participant allows");
  sub.add_option("participant", command->participant, "Code of the participant")->required();
  add_database(sub, command->database);
  sub.add_option("--gaze", command->gaze,
                 "Whether gaze may be recorded; no deletes the recorded gaze, also from the raw file")
      ->check(CLI::IsMember({"yes", "no"}));
  sub.add_option("--sharing", command->sharing,
                 "Whether public exports (BIDS, Psych-DS) may include the participant, with all sessions")
      ->check(CLI::IsMember({"yes", "no"}));
  add_incomplete(sub, command->incomplete);
  sub.footer(
      "Without --gaze and --sharing it changes nothing, and lists files that may hold refused gaze. Changes "
      "apply to all existing sessions and are logged; a consent page that is answered later replaces them "
      "for its session.");
  sub.callback([command] { consent(*command); });
}

}  // namespace apps
