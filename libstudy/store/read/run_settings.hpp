#pragma once
/// Reads the solver settings of live fluid from the stored options of a session's run. The options are a JSON
/// object; its member "settings" is a list of objects with "sha256" and "text" (the full setting file).

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// SQL expression for statements on the table `session`: the SHA-256 of each of the session's settings,
/// separated by spaces; NULL if there are none.
inline constexpr const char* setting_sha256_sql =
    "(SELECT group_concat(json_extract(e.value, '$.sha256'), ' ') FROM run r, json_each(iif(json_valid("
    "r.options), r.options, '{}'), '$.settings') e WHERE r.run_id = session.run_id)";
/// Meaning of the column setting_sha256 in the descriptions of exports.
inline constexpr const char* setting_sha256_meaning =
    "SHA-256 of each setting file (--setting) that live cells ran at, separated by spaces; the export holds "
    "each as setting_<first 12 digits>.toml; empty: the solver's usual settings";

struct RunSetting {
  std::string sha256;  ///< SHA-256 of `text`, computed from the stored text
  std::string text;    ///< full text of the setting file
};

/// The distinct settings of one session, in the order in which the run's options list them.
std::vector<RunSetting> run_settings(sqlite::Connection& database, std::int64_t session);
/// The distinct settings of all sessions.
std::vector<RunSetting> run_settings(sqlite::Connection& database);

/// Name of the setting's file in exports: "setting_<first 12 digits of the SHA-256>.toml".
std::string setting_file_name(const RunSetting& setting);

}  // namespace study
