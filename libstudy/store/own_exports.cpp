#include "libstudy/store/own_exports.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>

#include "libstudy/store/export_register.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using Json = base::Json;
using export_rows::this_host;

namespace {

constexpr std::size_t most_bytes = 1 << 28;

fs::path variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

fs::path state_folder() {
  if (std::getenv("VIP_STATE_DIR")) return variable("VIP_STATE_DIR");
  if (const fs::path state = variable("XDG_STATE_HOME"); state.is_absolute()) return state / "vip-lab";
  const fs::path home = variable("HOME");
  return home.is_absolute() ? home / ".local" / "state" / "vip-lab" : fs::path();
}

Json json_of(const OwnExport& made) {
  return {{"id", made.id},
          {"host", made.host},
          {"kind", made.kind},
          {"database", made.database.string()},
          {"path", made.path.string()},
          {"draft", made.draft.string()},
          {"sha256", made.sha256},
          {"people", made.people},
          {"deleted", made.deleted}};
}

std::optional<OwnExport> read_line(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    return OwnExport{.id = json.at("id"),
                     .host = json.at("host"),
                     .kind = json.at("kind"),
                     .database = json.at("database").get<std::string>(),
                     .path = json.at("path").get<std::string>(),
                     .draft = json.at("draft").get<std::string>(),
                     .sha256 = json.at("sha256"),
                     .people = json.at("people"),
                     .deleted = json.value("deleted", false)};
  } catch (const Json::exception&) {
    return {};
  }
}

/// base::Error if another user may write the register: that user could make this program delete any file.
void check_owner(const fs::path& file) {
  struct stat found {};
  if (::lstat(file.c_str(), &found) != 0) return;
  if (S_ISREG(found.st_mode) && found.st_uid == ::geteuid() && (found.st_mode & 022) == 0) return;
  throw base::Error(file.string(), "is not a file that only you may write to",
                    "check it, then delete it or make it private (chmod 600)");
}

std::vector<OwnExport> read_all(const fs::path& file) {
  check_owner(file);
  std::vector<OwnExport> all;
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return all;
  std::istringstream lines(base::read_file(file, most_bytes));
  for (std::string line; std::getline(lines, line);)
    if (auto made = read_line(line)) all.push_back(std::move(*made));
  return all;
}

/// Changes the list of registered exports by `how` and replaces the file. Makes a missing folder with mode
/// 0700, because the paths of exports are private too.
void change(const std::function<void(std::vector<OwnExport>&)>& how) {
  const fs::path file = own_exports_file();
  if (file.empty()) {
    throw base::Error("the register of exports", "has no folder",
                      "set VIP_STATE_DIR to a folder that you may write to");
  }
  base::make_folder_of(file.parent_path());
  if (::mkdir(file.parent_path().c_str(), 0700) != 0 && !fs::is_directory(file.parent_path()))
    throw base::Error(file.parent_path().string(), "cannot be created as a folder",
                      "set VIP_STATE_DIR to a folder that you may write to");
  const base::FileLock lock(file);
  std::vector<OwnExport> all = read_all(file);
  how(all);
  std::string text;
  for (const OwnExport& made : all) text += json_of(made).dump() + '\n';
  base::NewFile next(file, base::Readers::Owner);
  next.write(text);
  next.put_in_place();
}

std::string digest(const fs::path& path, const std::string& sha256) {
  return base::sha256_hex(path.string() + '\n' + sha256);
}

}  // namespace

std::string new_export_id() { return base::random_digits() + base::random_digits(); }

fs::path own_exports_file() {
  const fs::path folder = state_folder();
  return folder.empty() ? folder : folder / "exports.jsonl";
}

std::optional<std::string> why_not_registered() {
  try {
    change([](std::vector<OwnExport>&) {});
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

std::vector<OwnExport> own_exports_at(const fs::path& path) {
  std::vector<OwnExport> found = read_all(own_exports_file());
  std::erase_if(found, [&](const OwnExport& made) { return made.host != this_host() || made.path != path; });
  return found;
}

std::vector<OwnExport> own_exports_of(const fs::path& database) {
  std::vector<OwnExport> found = read_all(own_exports_file());
  std::erase_if(found, [&](const OwnExport& made) {
    return made.host != this_host() || made.database != database || made.deleted;
  });
  return found;
}

void keep_own_export(const OwnExport& made) {
  change([&](std::vector<OwnExport>& all) {
    std::erase_if(all, [&](const OwnExport& other) { return other.id == made.id; });
    all.push_back(made);
  });
}

void forget_own_exports(const std::set<std::string>& ids) {
  if (ids.empty()) return;
  change([&](std::vector<OwnExport>& all) {
    std::erase_if(all, [&](const OwnExport& made) { return ids.contains(made.id); });
  });
}

void will_delete_own_export(OwnExport made) {
  made.deleted = true;
  keep_own_export(made);
}

void has_deleted_own_export(const OwnExport& made) {
  keep_own_export({.id = made.id,
                   .host = made.host,
                   .kind = made.kind,
                   .database = {},
                   .path = {},
                   .draft = {},
                   .sha256 = digest(made.path, made.sha256),
                   .people = {},
                   .deleted = true});
}

bool was_deleted_here(const fs::path& path, const std::string& sha256) {
  const auto all = read_all(own_exports_file());
  return std::any_of(all.begin(), all.end(), [&](const OwnExport& made) {
    if (!made.deleted || made.host != this_host()) return false;
    return made.path.empty() ? made.sha256 == digest(path, sha256)
                             : made.path == path && made.sha256 == sha256;
  });
}

std::string marker_of(const std::string& kind) {
  // Only in the folder code does BIDS accept files that it does not define; Psych-DS, in the folder
  // materials.
  static const std::map<std::string, std::string> names{
      {"csv", "export.sha256"}, {"bids", "code/export.sha256"}, {"psych-ds", "materials/export.sha256"}};
  const auto name = names.find(kind);
  return name == names.end() ? "" : name->second;
}

std::string list_of_files(const fs::path& folder, const std::string& kind, const std::string& id) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    const bool is_file = entry.is_regular_file() && !entry.is_symlink();
    if (!is_file && entry.is_directory() && !entry.is_symlink()) continue;
    if (name != marker_of(kind)) files[name] = is_file ? base::sha256_of_file(entry.path()) : "no file";
  }
  std::string text = "# vip-study export " + id + "\n";
  for (const auto& [name, sha256] : files) text += sha256 + "  " + name + "\n";
  return text;
}

bool stands_unchanged(const OwnExport& made) {
  const fs::file_type type = fs::symlink_status(made.path).type();
  if (made.sha256.empty()) return false;
  if (marker_of(made.kind).empty())
    return type == fs::file_type::regular && base::sha256_of_file(made.path) == made.sha256;
  const fs::path marker = made.path / marker_of(made.kind);
  if (type != fs::file_type::directory || fs::symlink_status(marker).type() != fs::file_type::regular)
    return false;
  const std::string list = base::read_file(marker, most_bytes);
  return base::sha256_hex(list) == made.sha256 && list == list_of_files(made.path, made.kind, made.id);
}

}  // namespace study
