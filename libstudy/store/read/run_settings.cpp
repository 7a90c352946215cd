#include "libstudy/store/read/run_settings.hpp"

#include <optional>
#include <set>

#include "stats/base/file.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* texts_sql =
    "SELECT json_extract(e.value, '$.text') FROM session s JOIN run r USING (run_id), "
    "json_each(iif(json_valid("
    "r.options), r.options, '{}'), '$.settings') e WHERE ?1 IS NULL OR s.session_id = ?1 "
    "ORDER BY s.session_id, e.key";

std::vector<RunSetting> read(Connection& database, std::optional<std::int64_t> session) {
  std::vector<RunSetting> out;
  std::set<std::string> known;
  Statement row(database, texts_sql);
  row.bind_all(session);
  while (row.step()) {
    RunSetting one{base::sha256_hex(row.text(0)), row.text(0)};
    if (known.insert(one.sha256).second) out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::vector<RunSetting> run_settings(Connection& database, std::int64_t session) {
  return read(database, session);
}

std::vector<RunSetting> run_settings(Connection& database) { return read(database, {}); }

std::string setting_file_name(const RunSetting& setting) {
  return "setting_" + setting.sha256.substr(0, 12) + ".toml";
}

}  // namespace study
