#pragma once
/// Runs every command that opens a database on a spoilt one: it must be refused or handled correctly, and no
/// file outside its folder may change.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/fuzz/database_grammar.hpp"

namespace fuzz {

namespace fs = std::filesystem;

/// Result of a command: accepted, or refused with a message.
struct Outcome {
  bool taken = false;
  std::string message;
};

inline Outcome outcome_of(const std::function<void()>& command) {
  try {
    command();
    return {true, ""};
  } catch (const base::Error& error) {
    return {false, error.what()};
  }
}

/// Bytes of all files in a folder, by path, except those of one subfolder.
inline std::map<std::string, std::string> files_in(const fs::path& folder, const fs::path& but) {
  std::map<std::string, std::string> all;
  for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator(); ++at) {
    if (at->path() == but) at.disable_recursion_pending();
    all[at->path().string()] = at->is_regular_file() ? base::read_file(at->path(), 1u << 28) : "";
  }
  return all;
}

/// The schema as SQLite lists it, read without this project's code.
inline std::string schema_text(const fs::path& path) {
  sqlite3* database = nullptr;
  sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr);
  std::string text;
  const auto add = [](void* out, int, char** values, char**) {
    *static_cast<std::string*>(out) += std::string(values[0] ? values[0] : "") + '\n';
    return 0;
  };
  sqlite3_exec(database,
               "SELECT quote(type) || quote(name) || quote(tbl_name) || quote(sql) FROM sqlite_schema "
               "UNION ALL SELECT 'version' FROM pragma_user_version ORDER BY 1",
               add, &text, nullptr);
  sqlite3_close(database);
  return text;
}

/// Spoils a copy of `sound` in `folder`/box as the bytes choose, and tries all commands on it. Returns the
/// failures; empty if none.
inline std::vector<std::string> attack(const fs::path& folder, const fs::path& sound,
                                       const std::uint8_t* bytes, std::size_t size) {
  const fs::path box = folder / "box", study = box / "study.db";
  fs::remove_all(box);
  fs::create_directories(box);
  fs::copy_file(sound, study);
  fs::copy_file(sound.string() + ".answers.jsonl", study.string() + ".answers.jsonl");
  const auto statements = statements_of(bytes, size);
  spoil(study, statements);
  std::vector<std::string> wrong;
  const bool foreign = schema_text(study) != schema_text(sound);
  const auto outside = files_in(folder, box);
  const std::string spoilt = base::read_file(study, 1u << 28);
  const auto check = [&](const std::string& name, bool reads, const std::function<void()>& command) {
    const Outcome outcome = outcome_of(command);
    if (outcome.taken && foreign && name != "salvage") wrong.push_back(name + " took a foreign schema");
    if (outcome.message.find('\x1b') != std::string::npos)
      wrong.push_back(name + " printed an escape character");
    if (reads && base::read_file(study, 1u << 28) != spoilt) wrong.push_back(name + " changed what it reads");
    if (files_in(folder, box) != outside) wrong.push_back(name + " changed something outside of the folder");
  };
  check("status", true, [&] { study::read_status(study); });
  check("tasks", true, [&] { study::read_tasks(study); });
  check("sickness", true, [&] { study::read_sickness(study); });
  check("merge of it", true, [&] { study::merge({study}, box / "merged.db"); });
  check("salvage", true, [&] { study::salvage(study, box / "new.db"); });
  fs::copy_file(sound, box / "north.db");
  check("merge into it", false, [&] { study::merge({box / "north.db"}, study); });
  check("CSV", false, [&] { study::export_csv(study, box / "csv"); });
  check("BIDS", false, [&] { study::export_bids(study, box / "bids", true); });
  check("consent", false, [&] { study::change_permissions(study, "P01", {.gaze = false, .sharing = {}}); });
  check("withdraw", false, [&] { study::withdraw(study, "P01"); });
  check("resume", false, [&] { study::Store(study, study::sqlite::Open::Write).open_runs(); });
  if (!wrong.empty()) {
    for (const std::string& statement : statements) wrong.push_back("  " + statement);
  }
  return wrong;
}

}  // namespace fuzz
