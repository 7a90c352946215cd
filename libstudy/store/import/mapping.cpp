#include "libstudy/store/import/mapping.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/pattern.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace study {

namespace fs = std::filesystem;
using base::TomlTable;

namespace {

constexpr std::size_t most_mapping_bytes = 1 << 20;
constexpr std::size_t most_tool_bytes = 60;

constexpr std::array column_keys{"person", "visit", "order", "observer", "test_data", "answered", "started"};
constexpr std::array stimulus_keys{"mean_fps",    "sd_fps",  "scene",          "method",
                                   "n_star",      "effects", "shown_mean_fps", "shown_mean_arithmetic_fps",
                                   "shown_sd_fps"};

/// Names of a column of times: `key`_s or `key`_ms.
TimeColumn time_column(const TomlTable& table, const std::string& key) {
  const std::string s = table.string_or(key + "_s", ""), ms = table.string_or(key + "_ms", "");
  if (!s.empty() && !ms.empty())
    table.fail(key + "_ms", "is given beside " + key + "_s", "keep the one whose unit the column has");
  return ms.empty() ? TimeColumn{s, 1} : TimeColumn{ms, 1e-3};
}

std::vector<RowCondition> conditions(const TomlTable& table, const std::string& key) {
  std::vector<RowCondition> out;
  for (const TomlTable& one : table.tables(key)) {
    RowCondition condition{one.string("column"), {}};
    if (one.has("is")) {
      if (one.is_text("is"))
        condition.is = {one.string("is")};
      else
        condition.is = one.strings("is");
      if (condition.is.empty())
        one.fail("is", "is an empty list, so no row would be read",
                 "list texts, or remove the key to read all rows in which the column is not empty");
    }
    out.push_back(std::move(condition));
  }
  return out;
}

AnswerColumn answer_column(const TomlTable& table) {
  AnswerColumn out;
  out.question = table.string("question");
  out.column = table.string("column");
  out.key = table.string_or("key", "");
  if (table.has("choice_of")) {
    out.choice_of = table.strings("choice_of");
    if (out.choice_of.size() != 2)
      table.fail("choice_of", "does not name two columns",
                 "name the column of what was shown first, then that of what was shown second");
  }
  out.add = static_cast<int>(table.integer_or("add", 0, {-1000, 1000}));
  if (table.has("scores")) {
    const TomlTable scores = table.table("scores");
    for (const std::string& text : scores.keys())
      out.scores[text] = static_cast<int>(scores.integer(text, {-1e6, 1e6}));
    if (out.scores.empty()) table.fail("scores", "names no text", "write TEXT = SCORE, or remove the table");
    if (out.add != 0) table.fail("add", "is given beside scores", "write the final scores");
  }
  if (!out.choice_of.empty() && (out.add != 0 || !out.scores.empty()))
    table.fail("choice_of", "is given beside add or scores",
               "remove those: the answer is 1 for what was shown first and 2 for what was shown second");
  out.when = conditions(table, "when");
  const TimeColumn time = time_column(table, "response_time");
  out.response_time_column = time.column;
  out.response_time_unit_s = time.unit_s;
  return out;
}

void read_stimulus(const TomlTable& columns, StimulusColumns& out) {
  for (const char* key : stimulus_keys)
    if (columns.has(key)) out.columns[key] = columns.string(key);
  if (!columns.has("factors")) return;
  const TomlTable factors = columns.table("factors");
  for (const std::string& name : factors.keys()) out.factors[name] = factors.string(name);
}

/// Reads [columns.first] and [columns.second], the two stimuli of a pair.
void read_pair(const TomlTable& columns, ImportMapping& out) {
  for (const auto& [key, stimulus] : {std::pair("first", &out.first), std::pair("second", &out.second)}) {
    if (columns.has(key)) read_stimulus(columns.table(key), *stimulus);
    if (out.pairs() && stimulus->empty())
      columns.fail(key, "names no column, and the other stimulus of the pair has some",
                   "name the columns of both under [columns.first] and [columns.second]");
  }
  if (!out.pairs()) return;
  for (const char* key : stimulus_keys)
    if (out.stimulus.columns.contains(key) &&
        (out.first.columns.contains(key) || out.second.columns.contains(key)))
      columns.fail(key, "stands in [columns] and in a table of one stimulus",
                   "keep it in [columns] if one column holds it for both, else in both tables");
}

void read_columns(const TomlTable& root, ImportMapping& out) {
  if (!root.has("columns"))
    root.fail("", "has no table [columns]", "add [columns] with order = \"COLUMN\" and those of the setting");
  const TomlTable columns = root.table("columns");
  for (const char* key : column_keys)
    if (columns.has(key)) out.columns[key] = columns.string(key);
  out.onset = time_column(columns, "onset");
  read_stimulus(columns, out.stimulus);
  read_pair(columns, out);
  if (out.only_person.empty() && !out.columns.contains("person"))
    columns.fail("person",
                 "is missing: without a column of people, the trials of several people would count as one's",
                 "name the column with the participant codes, or write only_person = \"P01\" at the top of "
                 "the mapping if all rows are of one person");
  if (!out.only_person.empty() && out.columns.contains("person"))
    columns.fail("person", "is given beside only_person", "keep one of the two");
  if (out.rows_in_order == out.columns.contains("order"))
    columns.fail(
        "order", out.rows_in_order ? "is given beside rows_in_order" : "is missing",
        "name the column that numbers the trials of a visit, or write rows_in_order = true at the top "
        "of the mapping if each row is one trial and the rows are in the order of the trials");
}

/// The keys under which a stimulus names the column; those of factors begin with "factors.".
std::set<std::string> keys_of_column(const StimulusColumns& stimulus, const std::string& column) {
  std::set<std::string> out;
  for (const auto& [key, name] : stimulus.columns)
    if (name == column) out.insert(key);
  for (const auto& [factor, name] : stimulus.factors)
    if (name == column) out.insert("factors." + factor);
  return out;
}

/// Refuses a choice_of that contradicts [columns.first] and [columns.second].
void check_choice(const TomlTable& answer, const std::vector<std::string>& names, const ImportMapping& out) {
  if (names.empty() || !out.pairs()) return;
  const auto first = keys_of_column(out.first, names[0]), second = keys_of_column(out.second, names[1]);
  const std::string mend =
      "name a column of [columns.first], then that of [columns.second] with the same key";
  if (first.empty() && !keys_of_column(out.second, names[0]).empty())
    answer.fail("choice_of", "names " + names[0] + " first, which is a column of [columns.second]", mend);
  if (second.empty() && !keys_of_column(out.first, names[1]).empty())
    answer.fail("choice_of", "names " + names[1] + " second, which is a column of [columns.first]", mend);
  // Both may be columns that say nothing of the setting, such as names of files.
  if (first.empty() && second.empty()) return;
  if (std::none_of(first.begin(), first.end(), [&](const std::string& key) { return second.contains(key); }))
    answer.fail("choice_of",
                "names " + base::enumerated(names) + ", which do not hold the same of both stimuli", mend);
}

void read_frames(const TomlTable& root, ImportMapping& out) {
  if (!root.has("frames")) return;
  const TomlTable frames = root.table("frames");
  if (out.pairs()) {
    out.first.frames_file = frames.string("first_file");
    out.second.frames_file = frames.string("second_file");
  } else {
    out.stimulus.frames_file = frames.string("file");
  }
  out.frames_column = frames.string_or("column", "");
  out.frames_may_lack = frames.boolean_or("may_lack", false);
}

}  // namespace

fs::path find_mapping(const fs::path& named) {
  std::error_code ignored;
  if (fs::exists(named, ignored)) return named;
  const fs::path folder = base::resource("protocols/import");
  if (!named.has_parent_path()) {
    const fs::path shipped = folder / (named.string() + (named.extension() == ".toml" ? "" : ".toml"));
    if (fs::exists(shipped, ignored)) return shipped;
  }
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  throw base::Error(named.string(), "is neither a mapping file nor the name of one that comes with vip-study",
                    base::use_one_of(named.string(), names));
}

ImportMapping read_mapping(const fs::path& file) {
  ImportMapping out;
  out.text = base::read_file(file, most_mapping_bytes);
  out.sha256 = base::sha256_hex(out.text);
  const TomlTable root = base::parse_toml(out.text, file.string());
  root.integer("format", {1, 1});
  out.tool = root.string("tool");
  if (out.tool.empty() || out.tool.size() > most_tool_bytes || !base::is_plain_line(out.tool))
    root.fail("tool", "is no name of a program", "write 1 to 60 bytes of text, such as \"PsychoPy\"");
  if (root.has("files")) {
    if (root.is_text("files"))
      out.files = {root.string("files")};
    else
      out.files = root.strings("files");
  }
  if (root.has("sharing")) out.sharing = root.choice("sharing", {"allowed", "refused"});
  out.consent = root.string_or("consent", "");
  if (root.has("incomplete")) out.incomplete = root.choice("incomplete", {"stopped", "dropped out"});
  out.utc_offset = root.string_or("utc_offset", "");
  static const base::Pattern offset("[+-][01][0-9]:[0-5][0-9]");
  if (!out.utc_offset.empty() && !offset.match(out.utc_offset))
    root.fail("utc_offset", "is no offset from UTC", "write it as \"+02:00\" or \"-05:00\"");
  if (root.has("missing")) out.missing = root.strings("missing");
  if (root.has("not_asked")) out.not_asked = root.strings("not_asked");
  out.rows_in_order = root.boolean_or("rows_in_order", false);
  out.test_data = root.boolean_or("test_data", false);
  out.only_person = root.string_or("only_person", "");
  out.rows = conditions(root, "row");
  read_columns(root, out);
  for (const TomlTable& one : root.tables("answer")) {
    out.answers.push_back(answer_column(one));
    check_choice(one, out.answers.back().choice_of, out);
  }
  if (out.answers.empty())
    root.fail("", "has no table [[answer]]", "add [[answer]] with question = \"ID\" and column = \"COLUMN\"");
  read_frames(root, out);
  root.finish();
  return out;
}

}  // namespace study
