#pragma once
/// Solver settings of the live fluid, from the options of a session's run: JSON whose "settings" is a list of
/// objects with "sha256" and "text" (the setting file in full).

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// SQL for the SHA-256 of a session's settings, separated by spaces, in a statement with `session`; NULL:
/// none.
inline constexpr const char* setting_sha256_sql =
    "(SELECT group_concat(json_extract(e.value, '$.sha256'), ' ') FROM run r, json_each(iif(json_valid("
    "r.options), r.options, '{}'), '$.settings') e WHERE r.run_id = session.run_id)";
/// Meaning of the column setting_sha256 in every export.
inline constexpr const char* setting_sha256_meaning =
    "SHA-256 of each setting file (--setting) that live cells ran at, separated by spaces; the export holds "
    "each as setting_<first 12 digits>.toml; empty: the solver's usual settings";

struct RunSetting {
  std::string sha256;  ///< of the text, computed anew
  std::string text;    ///< the setting file
};

/// Settings of one session, in the order in which they were given.
std::vector<RunSetting> run_settings(sqlite::Connection& database, std::int64_t session);
/// Settings of all sessions, each once.
std::vector<RunSetting> run_settings(sqlite::Connection& database);

/// "setting_0123456789ab.toml".
std::string setting_file_name(const RunSetting& setting);

}  // namespace study
