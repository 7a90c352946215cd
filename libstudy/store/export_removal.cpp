/// Deletes registered exports that hold somebody who withdrew.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

#include "libstudy/store/export_register.hpp"
#include "libstudy/store/export_rows.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using export_rows::strike_out;
using export_rows::this_host;
using sqlite::Connection;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

constexpr std::size_t largest_file_bytes = std::size_t{1} << 32;

/// What a kill left of it, and what another deletion had begun with.
void remove_drafts(const fs::path& path) {
  std::error_code none;
  std::vector<fs::path> drafts;
  for (const auto& entry : fs::directory_iterator(path.parent_path(), none)) {
    std::string name = entry.path().filename().string();
    if (name.ends_with(".old")) name.resize(name.size() - 4);
    if (base::is_draft_name(name, path.filename().string())) drafts.push_back(entry.path());
  }
  for (const fs::path& draft : drafts) fs::remove_all(draft);
}

/// Aside first: the place never holds a part of it, which nobody would recognise.
void remove_whole(const fs::path& path) {
  const fs::path aside = draft_of(path);
  fs::rename(path, aside);
  fs::remove_all(aside);
}

std::string sha256_of(const fs::path& path) {
  const auto kind = fs::symlink_status(path).type();
  if (kind == fs::file_type::directory) return sha256_of_names(path);
  return kind == fs::file_type::regular ? base::sha256_hex(base::read_file(path, largest_file_bytes)) : "";
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

/// Why it is not deleted; empty: it is gone.
std::string remove_leftover(Connection& database, const Leftover& one) {
  if (one.host != this_host() && !one.host.empty()) {
    return "is on the computer '" + one.host +
           "'\n  mend: delete it there, with what was copied from it, or repeat the withdrawal there";
  }
  remove_drafts(one.path);
  if (!fs::exists(fs::symlink_status(one.path))) {
    const bool was_there = one.host.empty() || !one.sha256.empty();
    if (one.tackled || !was_there) return "";
    return "is no longer there\n  mend: where it was moved or copied to, delete it";
  }
  if (one.sha256.empty() && !one.host.empty()) return "";  // it was never put in place
  if (one.sha256.empty() || sha256_of(one.path) != one.sha256)
    return "is not as it was written: it was changed, or files were added\n  mend: delete it by hand";
  mark_tackled(database, one);
  remove_whole(one.path);
  return "";
}

void remove_empty_folders(Connection& database) {
  std::vector<std::pair<std::int64_t, std::string>> folders;
  Statement row(database,
                "SELECT export_id, path FROM export WHERE kind = ? AND host = ? ORDER BY path DESC");
  for (row.bind_all(export_rows::folder_kind, this_host()); row.step();)
    folders.emplace_back(row.integer(0), row.text(1));
  for (const auto& [id, path] : folders)
    if (::rmdir(path.c_str()) == 0 || errno == ENOENT) strike_out(database, id);
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
      if (problem.empty() && there) done.cleaned.push_back(one.path);
    } catch (const std::exception& error) {
      problem = std::string("cannot be deleted: ") + error.what() + "\n  mend: delete it by hand";
    }
    Transaction transaction(database);
    if (problem.empty()) {
      strike_out(database, one.id);
      ChorePlan(database).rewrite();
    } else {
      mark_tackled(database, one);
      done.left.push_back("export " + one.path.string() + " (" + one.kind + ") " + problem);
    }
    transaction.commit();
  }
  remove_empty_folders(database);
}

}  // namespace study
