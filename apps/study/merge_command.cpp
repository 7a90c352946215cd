/// vip-study merge: joins the databases of several stations.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/database_place.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/open_study.hpp"

namespace apps {

namespace {

struct MergeCommand {
  std::vector<std::string> sources;
  std::string into;
  bool incomplete = false;
};

/// Prints the balance of the design over all stations. Prints imbalances and their possible reasons on
/// stderr.
void print_balance(const study::Merge& done, const std::string& into) {
  std::vector<std::string> lines;
  for (const study::Balance& one : done.balance) lines.push_back(study::describe(one));
  print_list("Balance:", lines);
  for (const study::Balance& one : done.balance) {
    if (one.off())
      std::fprintf(stderr,
                   "%s: warning: %s %s is not balanced: some orders are used by at least two sessions more "
                   "than others\n",
                   into.c_str(), one.name.c_str(), one.version.c_str());
  }
  for (const std::string& trouble : done.station_troubles) {
    std::fprintf(stderr,
                 "%s\n  mend: give each station a number of its own for the sessions to come, such as "
                 "vip-study run --station 1/2 and --station 2/2\n",
                 ("warning: " + trouble).c_str());
  }
}

void merge(const MergeCommand& command) {
  study::warn_of_place(command.into);
  if (command.incomplete) {
    for (const std::string& source : command.sources) print_lacking(source, study::lacking_of(source));
  }
  const study::Merge done =
      study::merge({command.sources.begin(), command.sources.end()}, command.into, command.incomplete);
  std::printf("%s: %lld sessions, %lld of them test data; %lld copies recognised\n", command.into.c_str(),
              static_cast<long long>(done.sessions), static_cast<long long>(done.test_sessions),
              static_cast<long long>(done.recognised));
  print_list("Codes that were used for several people:", done.renamed);
  print_list("Withdrew, and left out of the merge:", done.withdrawn);
  print_list("Protocols of one name and version with different texts, kept apart:", done.namesakes);
  print_balance(done, command.into);
  for (const auto& [code, gone] : done.buried)
    std::printf("%lld answers of %s deleted here\n", static_cast<long long>(gone.answers), code.c_str());
  print_clean_up(done.beside);
  study::check_nothing_left(command.into, done.beside.left);
}

}  // namespace

void add_merge_command(CLI::App& app) {
  auto command = std::make_shared<MergeCommand>();
  CLI::App& sub = *app.add_subcommand("merge", "Join the databases of several stations");
  sub.add_option("databases", command->sources, "Databases to join; they stay as they are")->required();
  sub.add_option("--into", command->into, "Database to create, or an existing one to add them to")
      ->required()
      ->check(output_file());
  add_incomplete(sub, command->incomplete);
  sub.callback([command] { merge(*command); });
}

}  // namespace apps
