#include "tests/faults/commands.hpp"

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/faults/file_calls.hpp"

namespace faults {

const Person anna{"N01", "north"}, ben{"N02", "north"}, cleo{"N03", "north", false, false},
    dora{"S01", "south"};

namespace {

const std::vector<Person> north{anna, ben, cleo}, south{dora}, everyone{anna, ben, cleo, dora};

fs::path at(const fs::path& folder, const std::string& station) { return folder / station / "s.db"; }

void allow(const fs::path& database, const Person& person, bool allowed) {
  const auto done = study::change_permissions(database, person.code, {allowed, allowed});
  check_cleaned(database, done.left);
}

/// Withdraws a person, even if the interrupted command already recorded the withdrawal.
void withdraw(const fs::path& database, const Person& person, bool export_was_cut = false) {
  check_cleaned(database, study::withdraw(database, person.code).beside.left, export_was_cut);
}

void export_all(const fs::path& database) {
  const fs::path out = database.parent_path();
  study::export_csv(database, out / "csv", {true, true});
  study::export_bids(database, out / "bids", true);
  study::export_psych_ds(database, out / "psych");
}

void prepare_north(const fs::path& folder) { play(at(folder, "north"), north); }

/// Plays a new plan. If an error reports that the plan is already stored, resumes it as the error says.
void play_or_resume(const fs::path& database) {
  try {
    play(database, north);
  } catch (const base::Error& error) {
    if (std::string(error.what()).find("continue with vip-study resume") == std::string::npos) throw;
    resume(database, north);
  }
}

/// Makes exports of the station "north", and a backup such as an upgrade leaves.
void prepare_withdrawal(const fs::path& folder) {
  prepare_north(folder);
  const fs::path database = at(folder, "north");
  export_all(database);
  study::sqlite::Connection file(database, study::sqlite::Open::Write);
  study::sqlite::Statement(file, "VACUUM INTO ?").bind_all(database.string() + ".v5-then.bak").run();
}

/// The database "all" was merged from "north" before Ben withdrew and Anna refused gaze and sharing at
/// "north".
void prepare_merge(const fs::path& folder) {
  prepare_north(folder);
  play(at(folder, "south"), south);
  study::merge({at(folder, "north")}, at(folder, "all"));
  allow(at(folder, "north"), anna, false);
  withdraw(at(folder, "north"), ben);
}

void merge_all(const fs::path& folder) {
  const auto done = study::merge({at(folder, "north"), at(folder, "south")}, at(folder, "all"));
  check_cleaned(at(folder, "all"), done.beside.left);
}

/// Ben withdrew and Anna refused gaze and sharing after the backup that is restored was made.
void prepare_restored(const fs::path& folder) {
  prepare_north(folder);
  const fs::path database = at(folder, "north"), kept = folder / "kept.db";
  fs::copy_file(database, kept);
  allow(database, anna, false);
  withdraw(database, ben);
  fs::copy_file(kept, database, fs::copy_options::overwrite_existing);
  fs::remove(kept);
}

void prepare_salvage(const fs::path& folder) {
  prepare_north(folder);
  allow(at(folder, "north"), anna, false);
  withdraw(at(folder, "north"), ben);
  fs::resize_file(at(folder, "north"), fs::file_size(at(folder, "north")) / 4096 / 2 * 4096);
}

Command upgrade_from(int schema) {
  Command command;
  command.name = "upgrade from schema " + std::to_string(schema);
  command.prepare = [=](const fs::path& folder) {
    fs::create_directories(folder / "north");
    fs::copy_file(base::resource("tests/libstudy/fixtures/study_v" + std::to_string(schema) + ".db"),
                  at(folder, "north"));
    fs::permissions(at(folder, "north"), fs::perms::owner_read | fs::perms::owner_write);
  };
  command.act = [](const fs::path& folder) { study::Store(at(folder, "north"), study::sqlite::Open::Write); };
  command.other = command.act;
  command.stations = {"north"};
  return command;
}

Command exports_as(const std::string& name,
                   const std::function<void(const fs::path&, const fs::path&)>& write) {
  Command command;
  command.name = name;
  command.prepare = prepare_north;
  command.act = [=](const fs::path& folder) { write(at(folder, "north"), folder / "north" / "out"); };
  command.other = [](const fs::path& folder) { withdraw(at(folder, "north"), ben, true); };
  command.stations = {"north"};
  command.gone_by_other = {{"north", {ben}}};
  return command;
}

std::vector<Command> make_commands() {
  const auto on_north = [](auto work) { return [=](const fs::path& folder) { work(at(folder, "north")); }; };
  const auto go_on = [](const fs::path& folder) { resume(at(folder, "north"), north); };
  const auto play_north = on_north([](const fs::path& db) { play(db, north); });
  std::vector<Command> all;
  const auto add = [&](const char* name, Command::Work prepare, Command::Work act) -> Command& {
    all.push_back({name, std::move(prepare), std::move(act), {}, go_on, {"north"}});
    return all.back();
  };
  Command& run = add(
      "run", [](const fs::path& folder) { fs::create_directories(folder / "north"); }, play_north);
  run.is_read = false;
  run.again = run.other = on_north(play_or_resume);
  add("resume", on_north([](const fs::path& db) { play(db, north, 6); }), play_north);
  add("consent no", prepare_north, on_north([](const fs::path& db) { allow(db, ben, false); }));
  add("consent yes", prepare_north, on_north([](const fs::path& db) { allow(db, cleo, true); })).allowed = {
      cleo.key()};
  add("withdraw", prepare_withdrawal, on_north([](const fs::path& db) { withdraw(db, ben); })).gone = {
      {"north", {ben}}};
  add("withdraw, no exchange", prepare_withdrawal, on_north([](const fs::path& db) {
        refuse_exchanges();
        withdraw(db, ben);
      }))
      .gone = {{"north", {ben}}};
  Command& merge = add("merge", prepare_merge, merge_all);
  merge.stations = {"all", "north", "south"};
  merge.gone = {{"all", {ben}}, {"north", {ben}}};
  merge.other = [](const fs::path& folder) { resume(at(folder, "all"), everyone); };
  all.push_back(exports_as("export --csv", [](const fs::path& db, const fs::path& out) {
    study::export_csv(db, out, {true, true});
  }));
  all.push_back(exports_as(
      "export --bids", [](const fs::path& db, const fs::path& out) { study::export_bids(db, out, true); }));
  all.push_back(exports_as("export --psych-ds",
                           [](const fs::path& db, const fs::path& out) { study::export_psych_ds(db, out); }));
  Command& over =
      all.emplace_back(exports_as("export over, no exchange", [](const fs::path& db, const fs::path& out) {
        refuse_exchanges();
        study::export_csv(db, out, {true, true});
      }));
  over.prepare = [](const fs::path& folder) {
    prepare_north(folder);
    study::export_csv(at(folder, "north"), folder / "north" / "out", {true, true});
  };
  add("status", on_north([](const fs::path& db) { play(db, north, 6); }),
      on_north([](const fs::path& db) { study::read_status(db); }));
  Command& restored =
      add("resume on a backup", prepare_restored, on_north([](const fs::path& db) { resume(db, north); }));
  restored.refuses = true;
  restored.gone = {{"north", {ben}}};
  Command& salvage = add("salvage", prepare_salvage, [](const fs::path& folder) {
    study::salvage(at(folder, "north"), at(folder, "made"));
  });
  salvage.again = [](const fs::path& folder) {
    if (!fs::exists(at(folder, "made"))) study::salvage(at(folder, "north"), at(folder, "made"));
    study::Store(at(folder, "made"), study::sqlite::Open::Write);
  };
  salvage.other = salvage.again;
  salvage.stations = {"made"};
  salvage.gone = {{"made", {ben}}};
  salvage.is_read = false;
  for (int schema = 1; schema < static_cast<int>(study::read_schema_steps().size()); ++schema)
    if (fs::exists(base::resource("tests/libstudy/fixtures/study_v" + std::to_string(schema) + ".db")))
      all.push_back(upgrade_from(schema));
  return all;
}

}  // namespace

const std::vector<Command>& all_commands() {
  static const std::vector<Command> all = make_commands();
  return all;
}

}  // namespace faults
