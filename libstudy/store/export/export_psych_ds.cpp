#include "libstudy/store/export/export_psych_ds.hpp"

#include <array>
#include <map>
#include <set>
#include <span>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/sickness_table.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/read/run_settings.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using Json = base::Json;
using sqlite::Connection;

namespace {

const std::array page_columns{
    RatingColumn{"participant", "session", "session", "participant"},
    RatingColumn{"visit", "session", "session", "visit"},
    RatingColumn{"test_data", "session", "session", "test_data"},
    RatingColumn{"unit_position", "unit", "unit", "position"},
    RatingColumn{"block", "unit", "unit", "block"},
    RatingColumn{"block_kind", "unit", "unit", "kind"},
    RatingColumn{"question", "question", "question", "code"},
    RatingColumn{"score", "response", "response", "score"},
    RatingColumn{"response_time_s", "response", "response", "response_time_s"},
    RatingColumn{"input", "response", "response", "input"},
};

std::string pages_sql(std::int64_t session) {
  std::string list;
  for (const RatingColumn& column : page_columns)
    list += (list.empty() ? "" : ", ") + column.from + '.' + column.column + " AS " + column.name;
  return "SELECT " + list +
         " FROM response JOIN unit USING (unit_id) JOIN session USING (session_id) "
         "JOIN question USING (question_id) WHERE unit.trial_id IS NULL AND session.session_id = " +
         std::to_string(session) + " ORDER BY response.response_id";
}

bool is_psych_ds_export(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder / "data", ignored)) return false;
  const fs::path description = folder / description_file;
  if (!fs::is_regular_file(description, ignored) || fs::file_size(description, ignored) > 1u << 24)
    return false;
  const auto json = base::parse_json(base::read_file(description, 1u << 24));
  return json.is_object() && json.contains("creator") && json["creator"] == "vip-study";
}

bool is_psych_ds_name(const std::string& name) {
  return name == description_file || name == "README.md" || name.starts_with("data/study-") ||
         name.starts_with("materials/setting_");
}

constexpr ExportKind psych_ds_kind{"psych-ds", is_psych_ds_export, is_psych_ds_name};

std::string condition_of(const LabelledSession& session) {
  return "session.session_id = " + std::to_string(session.id);
}

/// Metadata of the columns of all files; a column that several files have is listed once. scored: the
/// sickness data of the exported sessions.
Json variables(Connection& database, const std::vector<LabelledSession>& sessions,
               std::span<const SicknessSession> scored) {
  std::map<std::string, std::string> meanings;
  std::vector<RatingColumn> columns = rating_columns(database, "0");
  std::set<std::string> protocols;  // protocols so far; all sessions of a protocol have the same columns
  for (const LabelledSession& session : sessions) {
    if (!protocols.insert(session.protocol).second) continue;
    const auto more = rating_columns(database, condition_of(session));
    columns.insert(columns.end(), more.begin(), more.end());
  }
  for (const RatingColumn& column : columns)
    meanings.emplace(column.name, meaning_of(database, column).meaning);
  for (const RatingColumn& column : page_columns)
    meanings.emplace(column.name, meaning_of(database, column).meaning);
  for (const SicknessTable& table : sickness_tables(scored)) {
    if (table.rows.empty())
      continue;  // the table has no file, so its columns are no variables of the data set
    for (const SicknessColumn& column : table.columns) meanings.emplace(column.name, column.meaning);
  }
  Json list = Json::array();
  for (const auto& [name, meaning] : meanings)
    list.push_back({{"@type", "PropertyValue"}, {"name", name}, {"description", meaning}});
  return list;
}

/// Writes the sickness tables of one session that have rows.
void write_scores(const SicknessSession& session, const std::string& stem, const ExportDraft& draft,
                  std::vector<ExportedFile>& files) {
  for (const SicknessTable& table : sickness_tables({&session, 1})) {
    std::string label = table.name;
    std::erase(label, '_');
    const std::string name = stem + "_description-" + label + "_data.csv";
    if (!table.rows.empty()) files.push_back({name, write_sickness(table, draft, name)});
  }
}

void write_description(Connection& database, const std::vector<LabelledSession>& sessions,
                       std::span<const SicknessSession> scored, const ExportDraft& draft) {
  const AboutDataSet about = about_data_set(database, sessions);
  const std::string simulated = (about.simulated.empty() ? "" : ". " + about.simulated) +
                                (about.imported.empty() ? "" : ". " + about.imported);
  const Json json{{"@context", "https://schema.org/"},
                  {"@type", "Dataset"},
                  {"name", about.name},
                  {"description", "Ratings of real-time fluid at controlled frame rates" + simulated},
                  {"creator", "vip-study"},
                  {"version", base::version()},
                  {"variableMeasured", variables(database, sessions, scored)}};
  write_file(draft, description_file, json.dump(2) + "\n");
  write_file(
      draft, "README.md",
      "# Ratings of real-time fluid\n\nOne file for each session in data/; dataset_description.json says "
      "what each column means. Empty: not known.\n\n" +
          (about.simulated.empty() ? "" : about.simulated + "\n\n") +
          (about.imported.empty() ? "" : about.imported + "\n\n") + "In every column, " +
          formula_guard_meaning + ".\n");
}

}  // namespace

PublicExport export_psych_ds(const StudyFile& study, const fs::path& folder) {
  open_study(study);  // throws for a damaged file before label_everybody() writes to it
  label_everybody(study.path);
  const auto database = open_to_export(study);
  database->execute("BEGIN");
  const auto sessions = shared_sessions(*database);
  const SharingCount people = count_sharing(*database);
  const auto sickness = read_sickness(*database);
  std::vector<SicknessSession> scored;
  ExportDraft draft({study.path, psych_ds_kind, people_of(sessions), Readers::AsUmask}, folder);
  std::vector<ExportedFile> files;
  std::set<std::string> named;
  base::make_folder_of(draft.path() / "data" / "of sessions");
  for (const LabelledSession& session : sessions) {
    const std::string stem =
        "data/study-" + session.protocol + "_subject-" + session.subject + "_session-" + session.session;
    const std::string ratings = stem + "_data.csv", pages = stem + "_description-pages_data.csv";
    const std::string sql = rating_table_sql(*database, condition_of(session));
    files.push_back({ratings, write_csv(*database, sql, draft, ratings)});
    files.push_back({pages, write_csv(*database, pages_sql(session.id), draft, pages)});
    for (const RunSetting& setting : run_settings(*database, session.id)) {
      // Psych-DS tools ignore files in materials/.
      const std::string name = "materials/" + setting_file_name(setting);
      if (named.insert(name).second) write_file(draft, name, setting.text);
    }
    for (const SicknessSession& one : sickness) {
      if (one.id != session.id) continue;
      write_scores(one, stem, draft, files);
      scored.push_back(one);
    }
  }
  write_description(*database, sessions, scored, draft);
  database->execute("COMMIT");
  draft.put_in_place();
  return {std::move(files), people};
}

}  // namespace study
