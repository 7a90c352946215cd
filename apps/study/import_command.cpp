/// vip-study import: takes answers and frame logs that another program recorded into a database.

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/database_place.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/store/import/read_import.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct ImportCommand {
  std::vector<std::string> sources;
  std::string protocol, mapping, database, sharing, consent;
  std::optional<double> trial_seconds;
};

/// base::Error unless the mapping or the options say what the participants allowed.
study::ImportTerms terms_of(const ImportCommand& command, const study::ImportMapping& mapping) {
  const std::string sharing = command.sharing.empty() ? mapping.sharing.value_or("") : command.sharing;
  const std::string consent = command.consent.empty() ? mapping.consent : command.consent;
  if (sharing.empty())
    throw base::Error(
        command.mapping, "does not say whether these data may stand in public exports",
        "write sharing = \"refused\" or \"allowed\" in the mapping, or give --sharing; refused is also "
        "right where nobody was asked");
  if (consent.empty())
    throw base::Error(
        command.mapping, "does not say where the participants' consent is recorded",
        "write it as consent = \"...\" in the mapping, or give --consent, such as \"signed forms in "
        "the lab, ethics number 12/2026\"");
  return {.tool = mapping.tool,
          .sharing = sharing == "allowed",
          .incomplete = mapping.incomplete,
          .options = base::Json{{"import", mapping.tool},
                                {"mapping", mapping.text},
                                {"mapping_sha256", mapping.sha256},
                                {"sharing", sharing},
                                {"consent", consent}}
                         .dump(),
          .mapping_sha256 = mapping.sha256};
}

void print_sources(const study::ReadImport& read) {
  std::set<std::string> left;
  for (const study::ReadSource& source : read.sources) {
    std::printf("%s: %zu of %zu rows are trials, SHA-256 %s\n",
                base::shortened(source.file.string(), 300).c_str(), source.used, source.rows,
                source.sha256.c_str());
    for (const std::string& name : source.left_columns) left.insert(base::shortened(name, 40));
  }
  if (!left.empty())
    std::printf("columns not imported, as the mapping does not name them: %s\n",
                base::joined({left.begin(), left.end()}).c_str());
}

void print_sessions(const study::ReadImport& read, const study::ImportTerms& terms,
                    const study::Protocol& protocol, const std::string& into) {
  std::size_t trials = 0, answers = 0, showings = 0, framed = 0, cut = 0, stated = 0, incomplete = 0,
              test = 0;
  std::set<std::string> people;
  for (const study::ImportedSession& session : read.sessions) {
    people.insert(session.participant);
    incomplete += session.complete ? 0 : 1;
    test += session.test_data || protocol.test_data ? 1 : 0;
    for (const study::ImportedTrial& trial : session.trials) {
      ++trials;
      for (const study::ImportedShowing& showing : trial.showings) {
        ++showings;
        framed += showing.frames ? 1 : 0;
        cut += showing.frames && showing.frames->cut ? 1 : 0;
        stated += !showing.frames && showing.stated.mean ? 1 : 0;
      }
      for (const study::ImportedAnswer& answer : trial.answers) answers += answer.score ? 1 : 0;
    }
  }
  std::printf("%s: %zu sessions of %zu people from %s, %zu trials, %zu answers\n", into.c_str(),
              read.sessions.size(), people.size(), terms.tool.c_str(), trials, answers);
  if (incomplete > 0)
    std::printf("%zu sessions without all trials count as %s\n", incomplete, terms.incomplete.c_str());
  std::printf(
      "timing: frames of %zu showings; of %zu only the rates that the source states; of %zu not recorded\n",
      framed, stated, showings - framed - stated);
  if (cut > 0)
    std::printf("the last line of %zu frame logs does not end, so its row may be cut and is left out\n", cut);
  if (test > 0)
    std::printf("test data: %zu of %zu sessions%s; they are never pooled with a study's\n", test,
                read.sessions.size(),
                protocol.trial_seconds ? ", as --trial-seconds changes the protocol" : "");
  std::printf("public exports: %s\n", terms.sharing ? "allowed" : "refused");
}

void import_study(const ImportCommand& command) {
  const study::ImportMapping mapping = study::read_mapping(study::find_mapping(command.mapping));
  const study::ImportTerms terms = terms_of(command, mapping);
  study::Protocol protocol = study::read_protocol(study::find_protocol(command.protocol));
  if (command.trial_seconds) study::override_trial_seconds(protocol, *command.trial_seconds);
  const study::ReadImport read = study::read_import(
      protocol, mapping, study::find_sources({command.sources.begin(), command.sources.end()}, mapping));
  study::warn_of_place(command.database);
  study::Store store(command.database, study::sqlite::Open::Create);
  store.add_import(protocol, terms, read.sessions);
  store.require_journal();
  print_sources(read);
  print_sessions(read, terms, protocol, command.database);
  const std::vector<std::string> left = store.left_to_clean();
  print_list("Not cleaned up:", left);
  study::check_nothing_left(command.database, left);
}

}  // namespace

void add_import_command(CLI::App& app) {
  auto command = std::make_shared<ImportCommand>();
  CLI::App& sub = *app.add_subcommand(
      "import", "Take answers and frame logs of PsychoPy, jsPsych, UXF or any CSV into a database");
  sub.add_option("sources", command->sources,
                 "CSV files, or folders in which to look for the files that the mapping names")
      ->required();
  sub.add_option("--protocol", command->protocol,
                 "Protocol that describes the study: a file, or the name of one that comes with the program")
      ->required();
  sub.add_option("--mapping", command->mapping,
                 "Mapping file (TOML), or psychopy, jspsych, uxf or vip_study: which column holds what")
      ->required();
  add_database(sub, command->database);
  sub.add_option(
         "--sharing", command->sharing,
         "Whether these data may stand in public exports, instead of what the mapping says; refused also "
         "where nobody was asked")
      ->check(CLI::IsMember({"allowed", "refused"}));
  sub.add_option("--consent", command->consent,
                 "Where the participants' consent is recorded, instead of what the mapping says");
  sub.add_option("--trial-seconds", command->trial_seconds,
                 "Length of each trial, s, if it differed from the protocol's; marks the data as test data")
      ->check(number_in(0.1, 3600));
  sub.footer("Nothing is stored unless every row fits the protocol. docs/data.md describes the mapping.");
  sub.callback([command] { import_study(*command); });
}

}  // namespace apps
