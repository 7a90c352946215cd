#pragma once
/// The solver settings that sessions' live fluid ran at, as the options of their runs hold them: JSON whose
/// "settings" is a list of objects with "sha256" and "text" (the setting file in full).

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// SQL of the SHA-256 of each, separated by spaces, within a statement that has `session`; NULL: none.
inline constexpr const char* setting_sha256_sql =
    "(SELECT group_concat(json_extract(e.value, '$.sha256'), ' ') FROM run r, json_each(iif(json_valid("
    "r.options), r.options, '{}'), '$.settings') e WHERE r.run_id = session.run_id)";
/// What that column says in every export.
inline constexpr const char* setting_sha256_meaning =
    "SHA-256 of each setting file (--setting) that live cells ran at, separated by spaces; the export holds "
    "each as setting_<first 12 digits>.toml; empty: the solver's usual settings";

struct RunSetting {
  std::string sha256;  ///< of the text, computed anew
  std::string text;    ///< the setting file
};

/// Of one session, in the order in which they were given.
std::vector<RunSetting> run_settings(sqlite::Connection& database, std::int64_t session);
/// Of all sessions, each once.
std::vector<RunSetting> run_settings(sqlite::Connection& database);

/// "setting_0123456789ab.toml".
std::string setting_file_name(const RunSetting& setting);

}  // namespace study
