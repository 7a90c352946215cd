/// vip-study salvage: makes a sound database from a damaged one and its journal of answers.
#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/store/salvage/salvage.hpp"

namespace apps {

namespace {

struct SalvageCommand {
  std::string database, into;
};

long long number(std::int64_t value) { return static_cast<long long>(value); }

void print_lost(const study::Salvage& done) {
  for (const auto& [participant, answers] : done.answers_lost)
    std::printf("lost: %lld answers of %s\n", number(answers), participant.c_str());
  if (done.frames_lost > 0) std::printf("lost: times of %lld frames\n", number(done.frames_lost));
  for (const auto& [table, rows] : done.rows_lost)
    std::printf("lost: %lld rows of %s that refer to rows not found\n", number(rows), table.c_str());
  if (done.unreadable > 0)
    std::printf("lost: %lld lines of the journal that cannot be read\n", number(done.unreadable));
  if (!done.sound && !done.journal)
    std::printf("There is no journal of answers: what else the destroyed pages held is not known.\n");
}

void salvage(const SalvageCommand& command) {
  const study::Salvage done = study::salvage(command.database, command.into);
  std::printf("%s: %s\n", command.database.c_str(),
              done.sound ? "SQLite finds nothing wrong with it" : "damaged, cut short or gone");
  std::printf("%s: %lld sessions, %lld frames\n", command.into.c_str(), number(done.sessions),
              number(done.frames));
  std::printf("  %lld answers from the database\n", number(done.answers_database));
  std::printf("  %lld answers from the journal alone%s\n", number(done.answers_journal),
              done.journal ? "" : " (there is none)");
  if (done.answers_under_way > 0)
    std::printf("  %lld of these were being written to the database when the program ended\n",
                number(done.answers_under_way));
  for (const std::string& line : done.different)
    std::printf("differs between database and journal, the database's was taken: %s\n", line.c_str());
  for (const std::string& part : done.left_out)
    std::printf("not of vip-study, and was left out: %s\n", part.c_str());
  for (const std::string& code : done.withdrawn)
    std::printf("withdrew, and was left out: %s\n", code.c_str());
  print_lost(done);
}

}  // namespace

void add_salvage_command(CLI::App& app) {
  auto command = std::make_shared<SalvageCommand>();
  CLI::App& sub = *app.add_subcommand(
      "salvage", "Make a sound database from a damaged or lost one and its journal of answers");
  sub.add_option("--db", command->database, "Database of the study, which stays as it is; it may be gone")
      ->required();
  sub.add_option("--into", command->into, "Database to make")->required()->check(output_file());
  sub.callback([command] { salvage(*command); });
}

}  // namespace apps
