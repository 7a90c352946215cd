#include "tests/faults/flows.hpp"

#include <stdexcept>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/protocols.hpp"

namespace faults {

namespace {

/// Note on a person who withdraws: it must be nowhere afterwards.
constexpr const char* secret = "zebra-of-the-north";

void call(const Arguments& arguments) {
  const auto ended = apps::test::run_program(arguments);
  if (ended.exit_code == 0) return;
  std::string line;
  for (const auto& word : arguments) line += word + " ";
  throw std::runtime_error(line + "ended with " + std::to_string(ended.exit_code) + ": " + ended.err);
}

Arguments run_arguments(const fs::path& folder, const std::string& database, const Arguments& people,
                        const std::string& station = "north") {
  Arguments all = vip_study({"run", folder / "short.toml", "--db", folder / database, "--observer", "random",
                             "--seed", "5", "--events", "--station", station});
  for (const auto& code : people) {
    all.push_back("--participant");
    all.push_back(code);
  }
  return all;
}

void write_protocol(const fs::path& folder) {
  base::write_file_atomically(folder / "short.toml", short_protocol());
}

void run_whole(const fs::path& folder, const std::string& database, const Arguments& people,
               const std::string& station = "north") {
  write_protocol(folder);
  call(run_arguments(folder, database, people, station));
}

Arguments resume_arguments(const fs::path& folder, const std::string& database) {
  return vip_study({"resume", "--db", folder / database, "--events"});
}

/// Kills a run of two sessions after it has printed 12 lines of events, in the middle of the first session.
void cut_session(const fs::path& folder) {
  write_protocol(folder);
  apps::test::Process program(run_arguments(folder, "s.db", {"P01", "P02"}));
  for (int line = 0; line < 12; ++line) program.read_line();
  program.send(SIGKILL);
  program.wait();
}

/// Adds the secret as a note on P02.
void note_secret(const fs::path& database) {
  const auto session = study::sqlite::Connection(database, study::sqlite::Open::Read)
                           .integer("SELECT session_id FROM session WHERE participant = 'P02'");
  study::Store(database, study::sqlite::Open::Write).note(session, {}, secret);
}

void prepare_withdrawal(const fs::path& folder) {
  run_whole(folder, "s.db", {"P01", "P02", "P03"});
  note_secret(folder / "s.db");
  // The export is registered in the folder in which the tested command looks for exports.
  Arguments all{"/usr/bin/env", "VIP_STATE_DIR=" + (folder / "state").string()};
  const Arguments made = vip_study({"export", "--db", folder / "s.db", "--csv", folder / "csv", "--words"});
  all.insert(all.end(), made.begin(), made.end());
  call(all);
}

Lines withdrawal_content(const fs::path& folder) {
  Lines all = database_content(folder / "s.db") + personal_content(folder / "s.db");
  std::string where;
  if (stands_in(folder, secret, where)) all.push_back("the note on P02 stands in " + where);
  return all;
}

/// Two stations that both used the code P01. P02 withdrew at the north station after its database had been
/// copied to all.db, as by an earlier merge.
void prepare_merge(const fs::path& folder) {
  run_whole(folder, "north.db", {"P01", "P02"}, "north");
  run_whole(folder, "south.db", {"P01", "P03"}, "south");
  fs::copy_file(folder / "north.db", folder / "all.db");
  fs::copy_file(folder / "north.db.personal", folder / "all.db.personal");
  call(vip_study({"withdraw", "P02", "--db", folder / "north.db", "--yes"}));
}

Lines merge_content(const fs::path& folder) {
  Lines all;
  for (const char* name : {"north.db", "south.db", "all.db"})
    all = all + Lines{name} + database_content(folder / name) + personal_content(folder / name);
  return all;
}

Arguments merge_arguments(const fs::path& folder) {
  return vip_study({"merge", folder / "north.db", folder / "south.db", "--into", folder / "all.db"});
}

Arguments consent_arguments(const fs::path& folder) {
  return vip_study({"consent", "P02", "--db", folder / "s.db", "--gaze", "no", "--sharing", "no"});
}

Lines consent_content(const fs::path& folder) {
  return session_content(folder / "s.db") + permission_content(folder / "s.db");
}

Lines export_content(const fs::path& folder) {
  return folder_content(folder / "csv") + folder_content(folder / "bids") + folder_content(folder / "psych");
}

Arguments export_arguments(const fs::path& folder) {
  return vip_study({"export", "--db", folder / "s.db", "--csv", folder / "csv", "--bids", folder / "bids",
                    "--psych-ds", folder / "psych"});
}

Arguments bake_arguments(const fs::path& folder) {
  return vip_study({"bake", "data/scenes/single_dam.toml", "--method", "LoRes", "--n-star", "64", "--backend",
                    "cpu", "--frames", "4", "--out", folder / "dam.bake"});
}

/// Verifies an existing bake, which must be complete; otherwise bakes again.
Arguments bake_or_verify(const fs::path& folder) {
  if (!fs::exists(folder / "dam.bake")) return bake_arguments(folder);
  return vip_study({"bake", "--verify", folder / "dam.bake"});
}

/// Cuts a database in half; its journal is whole.
void prepare_salvage(const fs::path& folder) {
  run_whole(folder, "s.db", {"P01", "P02"});
  fs::resize_file(folder / "s.db", fs::file_size(folder / "s.db") / 2);
}

Arguments salvage_arguments(const fs::path& folder) {
  return vip_study({"salvage", "--db", folder / "s.db", "--into", folder / "new.db"});
}

/// Reads an existing new database, which must be complete; otherwise salvages again.
Arguments salvage_or_look(const fs::path& folder) {
  if (!fs::exists(folder / "new.db")) return salvage_arguments(folder);
  return vip_study({"status", "--db", folder / "new.db"});
}

Lines salvage_content(const fs::path& folder) {
  Lines all{base::sha256_hex(base::read_file(folder / "s.db", 1u << 30))};
  // The journal has the content of the lost pages, except frames.
  for (const std::string& line : session_content(folder / "new.db")) {
    if (!line.starts_with("shown|")) all.push_back(line);
  }
  return all;
}

std::function<void(const fs::path&)> fixture(const std::string& name) {
  return [=](const fs::path& folder) {
    fs::copy_file(base::resource("tests/libstudy/fixtures/" + name), folder / "s.db");
    fs::permissions(folder / "s.db", fs::perms::owner_read | fs::perms::owner_write);
  };
}

Lines backed_up_answers(const fs::path& backup) {
  Lines all;
  for (const std::string& line : database_content(backup)) {
    if (line.starts_with("response|")) all.push_back(line);
  }
  return all;
}

/// The database's content, and the answers in its backup.
Lines upgraded_content(const fs::path& folder) {
  Lines backup;
  for (const auto& entry : fs::directory_iterator(folder)) {
    // There may be several equal backups.
    if (entry.path().extension() == ".bak") backup = backed_up_answers(entry.path());
  }
  // Timing lines are left out, because one session uses the real clock.
  Lines all;
  for (const std::string& line : session_content(folder / "s.db")) {
    if (!line.starts_with("shown|")) all.push_back(line);
  }
  return all + Lines{"backup"} + backup;
}

}  // namespace

fs::path program_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

Arguments vip_study(const Arguments& more) {
  Arguments all{program_folder() / "vip-study"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

const std::vector<Flow>& all_flows() {
  const auto of = [](const char* file, auto arguments) {
    return [=](const fs::path& folder) { return arguments(folder, file); };
  };
  const auto sessions = [](const fs::path& folder) {
    return session_content(folder / "s.db") + personal_content(folder / "s.db");
  };
  const auto run = [](const fs::path& folder) { return run_arguments(folder, "s.db", {"P01", "P02"}); };
  const auto two_people = [](const fs::path& folder) { run_whole(folder, "s.db", {"P01", "P02"}); };
  const auto go_on = [=](const fs::path& folder) {
    return is_planned(folder / "s.db") ? resume_arguments(folder, "s.db") : run(folder);
  };
  const auto withdraw = [](const fs::path& folder) {
    return vip_study({"withdraw", "P02", "--db", folder / "s.db", "--yes"});
  };
  const auto upgrade_from = [&](int schema) {
    const std::string number = std::to_string(schema);
    return Flow{"upgrade from schema " + number,
                fixture("study_v" + number + ".db"),
                of("s.db", resume_arguments),
                of("s.db", resume_arguments),
                upgraded_content,
                {"s.db"},
                "s.db",
                4};  // only one in four kinds of faults, because these sessions take seconds
  };
  static const std::vector<Flow> flows{
      {"run", write_protocol, run, go_on, sessions, {}, "s.db"},
      {"resume", cut_session, of("s.db", resume_arguments), go_on, sessions, {"s.db"}, "s.db"},
      {"withdraw", prepare_withdrawal, withdraw, withdraw, withdrawal_content, {"s.db"}, ""},
      {"merge",
       prepare_merge,
       merge_arguments,
       merge_arguments,
       merge_content,
       {"north.db", "south.db", "all.db"},
       ""},
      {"consent", two_people, consent_arguments, consent_arguments, consent_content, {"s.db"}, ""},
      {"export", two_people, export_arguments, export_arguments, export_content, {"s.db"}, ""},
      {"bake",
       [](const fs::path&) {},
       bake_arguments,
       bake_or_verify,
       [](const fs::path& folder) {
         return Lines{base::sha256_hex(base::read_file(folder / "dam.bake", 1u << 30))};
       },
       {},
       ""},
      {"salvage", prepare_salvage, salvage_arguments, salvage_or_look, salvage_content, {}, ""},
      upgrade_from(1),
      upgrade_from(2),
      upgrade_from(3),
      upgrade_from(4),
      upgrade_from(5),
      upgrade_from(6),
      upgrade_from(8),
      upgrade_from(9),
      upgrade_from(10),
      upgrade_from(11),
      upgrade_from(12),
      upgrade_from(13),
  };
  return flows;
}

std::string short_protocol() {
  return test::with_keys(test::without(test::protocol_text("ratings"), {"gaze_kept", "data_shared", "town"}),
                         {{"n_star", "[\"512\"]"},
                          {"mean_fps", "[20, 30]"},
                          {"sd_fps", "[0, 3]"},
                          {"duration_s", "1"},
                          {"accept", "[0, 1]"}});
}

}  // namespace faults
