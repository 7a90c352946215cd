/// Deletes registered exports that contain people who withdrew.
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

/// Removes the drafts that remain from a program that was killed while it wrote or deleted an export. Removes
/// only paths that this installation chose as draft names.
void remove_drafts(const std::vector<OwnExport>& made) {
  for (const OwnExport& one : made) {
    if (!base::is_draft_name(one.draft.string(), one.path.string())) continue;
    base::remove_durably(one.draft);
    base::remove_durably(one.draft.string() + ".old");
  }
}

/// Deletes an export. Renames a folder to its draft path first: a kill then leaves no partly deleted export
/// at made.path, which stands_unchanged() would not recognise.
void remove_whole(const OwnExport& made) {
  const bool is_folder = !marker_of(made.kind).empty();
  if (is_folder && !base::rename_durably(made.path, made.draft))
    throw base::Error(made.path.string(), std::string("cannot be moved: ") + std::strerror(errno),
                      "check the rights of its folder");
  base::remove_durably(is_folder ? made.draft : made.path);
}

/// A row of the table `export` whose export contains a person who withdrew.
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

/// Updates this installation's register for exports that no longer exist: reduces the entries of exports that
/// this program deleted to a digest (has_deleted_own_export()), and removes the other entries.
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

/// True if this database may delete the exports `made`, which this installation made at one path: at least
/// one of them was made from this database file, or contains a person who withdrew from it.
bool concerns(Connection& database, const std::vector<OwnExport>& made) {
  const fs::path here = fs::weakly_canonical(database.path());
  return std::any_of(made.begin(), made.end(), [&](const OwnExport& one) {
    return one.database == here || anyone_withdrew(database, one);
  });
}

/// Deletes the export at the path of `one` if it is registered, unchanged and contains a person who withdrew.
/// Returns the reason if it is not deleted. Returns an empty text if it was deleted, or if the path now has
/// an export without such a person and the export of `one` is known to be replaced or deleted.
std::string remove_standing(Connection& database, const Leftover& one, const std::vector<OwnExport>& made) {
  if (made.empty())
    return "was not registered by this installation (" + own_exports_file().string() +
           "), so it was not deleted\n  mend: check it; delete it by hand if it is an export of this study";
  const auto here = std::find_if(made.begin(), made.end(), stands_unchanged);
  if (here == made.end())
    return "is not as it was written: it was changed, or files were added\n  mend: delete it by hand";
  if (!anyone_withdrew(database, *here)) {
    if (one.tackled || here->database == fs::weakly_canonical(database.path()) ||
        was_deleted_here(one.path, one.sha256))
      return "";
    return "is no longer there: another export is now at its path\n  mend: delete it where it was moved or "
           "copied to";
  }
  mark_tackled(database, one);
  will_delete_own_export(*here);
  remove_whole(*here);
  forget(made);
  has_deleted_own_export(*here);
  return "";
}

/// Deletes the export of `one`, and drafts beside it. Returns the reason if it is not deleted; empty if
/// nothing of it is left. An export that was moved gives a reason once.
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

/// Removes empty folders that were made for exports and are in this installation's register.
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

namespace {

/// Deletes an export with a person who withdrew; returns why not.
std::string remove_of_service(const OwnExport& one) {
  if (!fs::exists(fs::symlink_status(one.path))) {
    settle_gone({one});
    return "";
  }
  if (!stands_unchanged(one)) {
    const auto others = own_exports_at(one.path);
    if (std::any_of(others.begin(), others.end(), stands_unchanged)) {  // a later export replaced it
      forget({one});
      return "";
    }
    return "holds a person who withdrew, and is not as it was written\n  mend: delete it by hand";
  }
  will_delete_own_export(one);
  remove_whole(one);
  forget({one});
  has_deleted_own_export(one);
  return "";
}

}  // namespace

void delete_exports_of_service(Connection& study, CleanUp& done) {
  const std::set<std::string> present = everybody(study);
  for (const OwnExport& one : own_exports_of(study.path())) {
    std::string problem;
    try {
      if (anyone_withdrew(study, one)) {
        const bool there = fs::exists(one.path);
        problem = remove_of_service(one);
        if (there && !fs::exists(one.path)) done.cleaned.push_back(one.path);
      } else if (fs::exists(one.path) &&
                 !std::includes(present.begin(), present.end(), one.people.begin(), one.people.end())) {
        problem = "holds a person whom " + study.path().string() +
                  " does not show any more\n  mend: delete it, and export again";
      }
    } catch (const std::exception& error) {
      problem = std::string("cannot be deleted: ") + error.what() + "\n  mend: delete it by hand";
    }
    if (!problem.empty())
      done.left.push_back("export " + base::shortened(one.path.string(), longest_path) + " (" +
                          base::shortened(one.kind) + ") " + problem);
  }
  if (done.cleaned.empty()) return;
  for (const OwnExport& one : own_exports_of(study.path())) {
    if (one.kind == export_rows::folder_kind && ::rmdir(one.path.c_str()) == 0) forget({one});
  }
}

}  // namespace study
