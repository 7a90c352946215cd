#include "libstudy/analysis/tasks/scale_table.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "stats/base/csv.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// The most conditions and different scores of one scale.
constexpr std::size_t most_conditions = 300, most_scores = 25;

int number_in(std::map<std::string, int>& numbers, std::vector<std::string>& list, const std::string& text) {
  const auto [place, fresh] = numbers.try_emplace(text, static_cast<int>(list.size()));
  if (fresh) list.push_back(text);
  return place->second;
}

/// The columns of a CSV file that both kinds of answers share.
struct SharedColumns {
  std::optional<std::size_t> person, count, by;

  SharedColumns(const base::CsvTable& table, const std::string& by_name) {
    person = table.find("person");
    count = table.find("count");
    if (!by_name.empty()) by = table.column(by_name);
  }
};

/// A name in a row; base::Error unless it is one line of text.
const std::string& name_in(const base::CsvTable& table, const base::CsvRow& row, std::size_t column) {
  const std::string& text = row.fields[column];
  if (text.empty() || !base::is_plain_line(text) || text.size() > 200)
    table.fail(row,
               "has no name of one line and up to 200 bytes in the column " +
                   base::shortened(table.columns()[column], 40),
               column == table.find("person")
                   ? "name the person in each row; without the column person there are no intervals"
                   : "fill the field");
  return text;
}

double count_in(const base::CsvTable& table, const base::CsvRow& row, const SharedColumns& columns) {
  if (!columns.count) return 1;
  const auto count = base::parse_number<int>(row.fields[*columns.count]);
  if (!count || *count < 0 || *count > 1'000'000'000)
    table.fail(row, "has the count \"" + base::shortened(row.fields[*columns.count], 40) + "\"",
               "give a whole number from 0 to 1000000000, or remove the column count");
  return *count;
}

void note_other_columns(const base::CsvTable& table, const std::set<std::string>& used,
                        std::vector<std::string>& notes) {
  std::vector<std::string> others;
  for (const std::string& name : table.columns())
    if (!used.contains(name)) others.push_back(base::shortened(name, 40));
  if (!others.empty())
    notes.push_back("not used of " + std::filesystem::path(table.file()).filename().string() + ": " +
                    base::enumerated(others) + "; --by COLUMN gives each of its values a scale of its own.");
}

void add_choices(const base::CsvTable& table, const std::string& by, ScaleCollector& out) {
  const SharedColumns columns(table, by);
  const std::size_t first = table.column("first"), second = table.column("second"),
                    chosen = table.column("chosen");
  for (const base::CsvRow& row : table.rows()) {
    const std::string &a = name_in(table, row, first), &b = name_in(table, row, second);
    const std::string& choice = row.fields[chosen];
    if (a == b)
      table.fail(row, "compares " + base::shortened(a) + " with itself",
                 "name two conditions, or remove the row");
    if (a == "first" || a == "second" || b == "first" || b == "second")
      table.fail(row, "names a condition \"first\" or \"second\", words of the column chosen",
                 "give the condition another name");
    const bool is_first = choice == "first" || choice == a;
    if (!is_first && choice != "second" && choice != b)
      table.fail(row, "has chosen \"" + base::shortened(choice, 40) + "\"",
                 "write first, second, or the name of the chosen condition; remove rows without an answer");
    const double count = count_in(table, row, columns);
    if (count > 0)
      out.add_choice(columns.by ? name_in(table, row, *columns.by) : "",
                     columns.person ? name_in(table, row, *columns.person) : "", a, b, is_first, count);
  }
}

void add_ratings(const base::CsvTable& table, const std::string& by, ScaleCollector& out) {
  const SharedColumns columns(table, by);
  const std::size_t condition = table.column("condition"), score = table.column("score");
  for (const base::CsvRow& row : table.rows()) {
    const auto value = base::parse_number<int>(row.fields[score]);
    if (!value)
      table.fail(row, "has the score \"" + base::shortened(row.fields[score], 40) + "\"",
                 "give a whole number; remove rows without an answer");
    const double count = count_in(table, row, columns);
    if (count > 0)
      out.add_rating(columns.by ? name_in(table, row, *columns.by) : "",
                     columns.person ? name_in(table, row, *columns.person) : "",
                     name_in(table, row, condition), *value, count);
  }
}

}  // namespace

void ScaleCollector::add_choice(const std::string& group, const std::string& person, const std::string& first,
                                const std::string& second, bool first_chosen, double count) {
  Part& part = part_of(group);
  const int a = number_in(part.numbers, part.conditions, first),
            b = number_in(part.numbers, part.conditions, second);
  auto& cell = part.pairs[{number_in(person_numbers_, people_, person), a, b}];
  (first_chosen ? cell.first : cell.second) += count;
}

void ScaleCollector::add_rating(const std::string& group, const std::string& person,
                                const std::string& condition, int score, double count) {
  Part& part = part_of(group);
  part.ratings[{number_in(person_numbers_, people_, person),
                number_in(part.numbers, part.conditions, condition), score}] += count;
  part.scores.insert(score);
}

ScaleCollector::Part& ScaleCollector::part_of(const std::string& name) {
  const auto place = static_cast<std::size_t>(number_in(group_numbers_, groups_, name));
  if (place == parts_.size()) parts_.push_back({name});
  return parts_[place];
}

void ScaleCollector::finish(ScaleTable& table, const std::string& place) {
  if (parts_.empty()) throw base::Error(place, "holds no answer", "give answers; a row with count 0 is none");
  for (Part& part : parts_) {
    const std::string where = part.name.empty() ? place : place + ", " + table.by + " " + part.name;
    if (part.conditions.size() > most_conditions)
      throw base::Error(where,
                        "has " + std::to_string(part.conditions.size()) + " conditions; a scale holds " +
                            std::to_string(most_conditions),
                        "give each of several parts a scale of its own with --by");
    if (part.scores.size() > most_scores)
      throw base::Error(where,
                        "has ratings of " + std::to_string(part.scores.size()) +
                            " different scores; the scale takes " + std::to_string(most_scores),
                        "join neighbouring scores of a fine scale, or leave the ratings out");
    ScaleGroup group{part.name, std::move(part.conditions), {}};
    group.data.conditions = static_cast<int>(group.conditions.size());
    group.data.people_known = table.people_known;
    for (const auto& [key, counts] : part.pairs)
      group.data.pairs.push_back(
          {std::get<0>(key), std::get<1>(key), std::get<2>(key), counts.first, counts.second});
    for (const auto& [key, count] : part.ratings)
      group.data.ratings.push_back({std::get<0>(key), std::get<1>(key), std::get<2>(key), count});
    table.groups.push_back(std::move(group));
  }
  if (table.people_known) table.people = std::move(people_);
}

ScaleTable scale_table_of_csv(const std::filesystem::path& choices, const std::filesystem::path& ratings,
                              const std::string& by) {
  for (const char* own : {"first", "second", "chosen", "condition", "score", "count"})
    if (by == own)
      throw base::Error("--by " + by, "is a column of the answers themselves",
                        "name a column that says where or when they were given, such as scene");
  ScaleTable out{.by = by};
  ScaleCollector collector;
  const auto read = [&](const std::filesystem::path& file, const std::set<std::string>& own, auto add) {
    const base::CsvTable table(file);
    if (table.rows().empty()) throw base::Error(file.string(), "holds no answer", "give a file with answers");
    add(table, by, collector);
    std::set<std::string> used = own;
    used.insert({"person", "count", by});
    note_other_columns(table, used, out.notes);
    if (table.find("person")) return;
    out.people_known = false;
    out.warnings.push_back(file.filename().string() +
                           " has no column person: many answers may come from few people, or from one. There "
                           "are no intervals, tests and observers; nothing is said of people in general.");
  };
  read(choices, {"first", "second", "chosen"}, add_choices);
  if (!ratings.empty()) read(ratings, {"condition", "score"}, add_ratings);
  collector.finish(out, choices.string());
  return out;
}

}  // namespace study
