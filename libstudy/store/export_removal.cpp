/// Deletes registered exports that hold somebody who withdrew.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "libstudy/store/export_register.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/new_file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;
using export_rows::this_host;
using sqlite::Connection;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

constexpr std::size_t longest_path = 4096;

/// Removes what a kill left of exports or of begun deletions, under draft names that this installation chose.
void remove_drafts(const std::vector<OwnExport>& made) {
  for (const OwnExport& one : made) {
    if (!base::is_draft_name(one.draft.string(), one.path.string())) continue;
    base::remove_durably(one.draft);
    base::remove_durably(one.draft.string() + ".old");
  }
}

/// Moves it aside first, so that the path never has a partial export, which would not be recognised.
void remove_whole(const OwnExport& made) {
  const bool is_folder = !marker_of(made.kind).empty();
  if (is_folder && !base::rename_durably(made.path, made.draft))
    throw base::Error(made.path.string(), std::string("cannot be moved: ") + std::strerror(errno),
                      "check the rights of its folder");
  base::remove_durably(is_folder ? made.draft : made.path);
}

/// A row of `export` that holds somebody who withdrew.
struct Leftover {
  std::int64_t id = 0;
  std::string kind, host, sha256;
  fs::path path;
  bool tackled = false;
};

std::vector<Leftover> leftovers(Connection& database) {
  Statement row(database,
                "SELECT export_id, kind, host, sha256, path, tackled FROM export e WHERE EXISTS "
                "(SELECT 1 FROM export_person JOIN tombstone USING (person) WHERE export_id = e.export_id) "
                "ORDER BY host, path");
  std::vector<Leftover> all;
  while (row.step())
    all.push_back({.id = row.integer(0),
                   .kind = row.text(1),
                   .host = row.text(2),
                   .sha256 = row.text(3),
                   .path = row.text(4),
                   .tackled = row.integer(5) != 0});
  return all;
}

void mark_tackled(Connection& database, const Leftover& one) {
  Statement(database, "UPDATE export SET tackled = 1 WHERE export_id = ?").bind_all(one.id).run();
}

bool anyone_withdrew(Connection& database, const OwnExport& made) {
  Statement stone(database, "SELECT 1 FROM tombstone WHERE person = ?");
  return std::any_of(made.people.begin(), made.people.end(),
                     [&](const std::string& person) { return stone.bind_all(person).step(); });
}

void forget(const std::vector<OwnExport>& made) {
  std::set<std::string> ids;
  for (const OwnExport& one : made) ids.insert(one.id);
  forget_own_exports(ids);
}

/// Of missing exports, the register keeps only those that this program deleted.
void settle_gone(const std::vector<OwnExport>& made) {
  std::vector<OwnExport> moved;
  for (const OwnExport& one : made) {
    if (one.deleted)
      has_deleted_own_export(one);
    else
      moved.push_back(one);
  }
  forget(moved);
}

/// True if this database may decide on exports that this installation made at a path: one has a person who
/// withdrew here, or was made from this very file.
bool concerns(Connection& database, const std::vector<OwnExport>& made) {
  const fs::path here = fs::weakly_canonical(database.path());
  return std::any_of(made.begin(), made.end(), [&](const OwnExport& one) {
    return one.database == here || anyone_withdrew(database, one);
  });
}

/// Why the file or folder at its path is not deleted; empty: it is deleted, or holds nobody who withdrew.
std::string remove_standing(Connection& database, const Leftover& one, const std::vector<OwnExport>& made) {
  if (made.empty())
    return "was not registered by this installation (" + own_exports_file().string() +
           "), so that nothing there is deleted\n  mend: look at it; delete it by hand if it is an export of "
           "this study";
  const auto here = std::find_if(made.begin(), made.end(), stands_unchanged);
  if (here == made.end())
    return "is not as it was written: it was changed, or files were added\n  mend: delete it by hand";
  if (!anyone_withdrew(database, *here)) {
    if (one.tackled || here->database == fs::weakly_canonical(database.path()) ||
        was_deleted_here(one.path, one.sha256))
      return "";
    return "is no longer there: another export stands in its place\n  mend: delete it where it was moved or "
           "copied to";
  }
  mark_tackled(database, one);
  will_delete_own_export(*here);
  remove_whole(*here);
  forget(made);
  has_deleted_own_export(*here);
  return "";
}

/// Why it is not deleted; empty if it is gone.
std::string remove_leftover(Connection& database, const Leftover& one) {
  if (one.host != this_host() && !one.host.empty()) {
    return "is on the computer '" + base::shortened(one.host) +
           "'\n  mend: delete it there, with what was copied from it, or repeat the withdrawal there";
  }
  const std::vector<OwnExport> made = own_exports_at(one.path);
  const bool concerned = concerns(database, made);
  if (concerned) remove_drafts(made);
  if (fs::exists(fs::symlink_status(one.path))) {
    const bool never_placed = one.sha256.empty() && !one.host.empty();
    return never_placed ? "" : remove_standing(database, one, made);
  }
  base::sync_folder_of(one.path);
  if (concerned) settle_gone(made);
  const bool was_there = one.host.empty() || !one.sha256.empty();
  if (one.tackled || !was_there || was_deleted_here(one.path, one.sha256)) return "";
  return "is no longer there\n  mend: delete it where it was moved or copied to";
}

/// Removes only folders that this installation made.
void remove_empty_folders(Connection& database) {
  std::vector<std::pair<std::int64_t, fs::path>> folders;
  Statement row(database,
                "SELECT export_id, path FROM export WHERE kind = ? AND host = ? ORDER BY path DESC");
  for (row.bind_all(export_rows::folder_kind, this_host()); row.step();)
    folders.emplace_back(row.integer(0), row.text(1));
  for (const auto& [id, path] : folders) {
    std::vector<OwnExport> made = own_exports_at(path);
    std::erase_if(made, [](const OwnExport& one) { return one.kind != export_rows::folder_kind; });
    if (made.empty() || (::rmdir(path.c_str()) != 0 && errno != ENOENT)) continue;
    base::sync_folder_of(path);
    forget(made);
    export_rows::strike_out(database, id);
  }
}

}  // namespace

bool holds_withdrawn(Connection& database) {
  const auto all = leftovers(database);
  return std::any_of(all.begin(), all.end(),
                     [](const Leftover& one) { return one.host.empty() || one.host == this_host(); });
}

void delete_exports_of_withdrawn(Connection& database, CleanUp& done) {
  for (const Leftover& one : leftovers(database)) {
    std::string problem;
    try {
      const bool there = fs::exists(one.path);
      problem = remove_leftover(database, one);
      if (there && !fs::exists(one.path)) done.cleaned.push_back(one.path);
    } catch (const std::exception& error) {
      problem = std::string("cannot be deleted: ") + error.what() + "\n  mend: delete it by hand";
    }
    Transaction transaction(database);
    if (problem.empty()) {
      export_rows::strike_out(database, one.id);
      ChorePlan(database).rewrite();
    } else {
      mark_tackled(database, one);
      done.left.push_back("export " + base::shortened(one.path.string(), longest_path) + " (" +
                          base::shortened(one.kind) + ") " + problem);
    }
    transaction.commit();
  }
  remove_empty_folders(database);
}

}  // namespace study
