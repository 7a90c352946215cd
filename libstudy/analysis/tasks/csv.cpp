#include "libstudy/analysis/tasks/csv.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

const std::vector<std::string> exclusion_columns{"task", "participant", "visit", "position",
                                                 "rule", "reason",      "actor", "answers"};

using Fields = std::vector<std::pair<std::string, std::string>>;

/// A JSON value as a CSV field. A text that a spreadsheet would take for a formula is guarded, except "-Inf",
/// which is a number.
std::string scalar(const Json& value) {
  if (value.is_null()) return {};
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (!value.is_string()) return value.dump();
  const auto text = value.get<std::string>();
  return text == "-Inf" ? text : csv_field(text);
}

bool all_texts(const Json& list) {
  return std::all_of(list.begin(), list.end(), [](const Json& one) { return one.is_string(); });
}

/// True if the list has two entries and a name that the results give to intervals only. The types of the
/// entries cannot decide, because an infinite end is a text and not a number.
bool is_interval(const std::string& name, const Json& list) {
  return list.size() == 2 && (name.ends_with("ci") || name.ends_with("bca") || name == "clopper_pearson" ||
                              name == "wilson" || name == "range");
}

void flatten(const std::string& name, const Json& value, Fields& fields) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      flatten(name.empty() ? key : name + "_" + key, inner, fields);
  } else if (!value.is_array()) {
    fields.emplace_back(name, scalar(value));
  } else if (is_interval(name, value)) {
    fields.emplace_back(name + "_low", scalar(value[0]));
    fields.emplace_back(name + "_high", scalar(value[1]));
  } else if (!value.empty() && all_texts(value)) {
    std::string joined;
    for (const auto& one : value) joined += (joined.empty() ? "" : " ") + one.get<std::string>();
    fields.emplace_back(name, csv_field(joined));
  }
}

/// True if another line has an interval of this name, so that the columns `name`_low and `name`_high exist. A
/// null of this name then gets no column.
bool names_interval(const std::vector<std::string>& columns, const std::string& name) {
  return std::find(columns.begin(), columns.end(), name + "_low") != columns.end();
}

std::vector<std::string> columns_of(const std::vector<Fields>& lines) {
  std::vector<std::string> columns;
  for (const Fields& line : lines) {
    for (const auto& [name, value] : line) {
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
    }
  }
  std::vector<std::string> out;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(out),
               [&](const std::string& name) { return !names_interval(columns, name); });
  return out;
}

/// One line for each test of each hypothesis: first the hypothesis's fields, then the test's.
Json tests_of(const Json& hypotheses) {
  Json list = Json::array();
  for (const auto& one : hypotheses) {
    for (const auto& test : one.at("tests")) {
      Json line{{"id", one.at("id")},
                {"kind", one.at("kind")},
                {"family", one.at("family")},
                {"status", one.at("status")}};
      if (one.contains("paper")) line["paper_status"] = one.at("paper").at("status");
      line.update(test);
      list.push_back(std::move(line));
    }
  }
  return list;
}

/// One line for each entry of the list `name` in each model, such as "effects": the model's other fields,
/// then the entry's. A model without the list gets one line.
Json entries_of(const Json& models, const std::string& name) {
  Json list = Json::array();
  for (const auto& model : models) {
    Json head = model;
    head.erase(name);
    if (!model.contains(name)) {
      list.push_back(head);
      continue;
    }
    for (const auto& entry : model.at(name)) {
      Json line = head;
      line.update(entry);
      list.push_back(std::move(line));
    }
  }
  return list;
}

Json sensitivity_lines(const Json& variants) {
  Json list = Json::array();
  for (const auto& variant : variants) {
    if (!variant.contains("hypotheses")) {
      list.push_back(variant);
      continue;
    }
    for (const auto& hypothesis : variant.at("hypotheses")) {
      for (const auto& test : hypothesis.at("tests")) {
        Json line{{"id", variant.at("id")},
                  {"task", variant.at("task")},
                  {"hypothesis", hypothesis.at("id")},
                  {"status", hypothesis.at("status")}};
        line.update(test);
        list.push_back(std::move(line));
      }
    }
  }
  return list;
}

/// One line for each entry of the list at `pointer` in each part of "sickness", with the part's protocol
/// first.
Json sickness_lines(const Json& parts, const Json::json_pointer& pointer) {
  Json list = Json::array();
  for (const auto& part : parts) {
    if (!part.contains(pointer)) continue;
    for (const auto& entry : part.at(pointer)) {
      Json line{{"protocol", part.at("protocol").at("name")}};
      line.update(entry);
      list.push_back(std::move(line));
    }
  }
  return list;
}

/// One line for each stimulus and each table of the sweep in which the stimulus's setting was measured.
Json sweep_lines(const Json& costs) {
  Json list = Json::array();
  for (const auto& one : costs) {
    if (!one.contains("sweep") || !one.at("sweep").is_array()) continue;
    for (const auto& price : one.at("sweep")) {
      Json line;
      for (const char* name : {"task", "scene", "n_star", "method", "setting", "said", "answers"})
        line[name] = one.at(name);
      for (const auto& [name, value] : price.items()) line[name == "scene" ? "sweep_scene" : name] = value;
      list.push_back(std::move(line));
    }
  }
  return list;
}

}  // namespace

std::string csv_text(const Json& list, const std::vector<std::string>& if_empty) {
  std::vector<Fields> lines;
  for (const auto& object : list) flatten("", object, lines.emplace_back());
  const auto columns = lines.empty() ? if_empty : columns_of(lines);
  std::string out;
  for (const auto& column : columns) out += (out.empty() ? "" : ",") + csv_field(column);
  out += "\r\n";
  for (const Fields& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto field =
          std::find_if(line.begin(), line.end(), [&](const auto& one) { return one.first == columns[i]; });
      text += (i > 0 ? "," : "") + (field == line.end() ? std::string() : field->second);
    }
    out += text + "\r\n";
  }
  return out;
}

namespace {

void write_document(const Json& results, const std::filesystem::path& folder, const WriteFile& write) {
  std::vector<std::pair<std::string, Json>> lists{
      {"timing", results.at("timing")},
      {"timing_totals", results.value("timing_totals", Json::array())},
      {"timing_stations", results.value("timing_stations", Json::array())},
      {"response_times", results.value("response_times", Json::array())},
      {"hypotheses", tests_of(results.at("hypotheses"))},
      {"sensitivity", sensitivity_lines(results.at("sensitivity"))}};
  const Json descriptives = entries_of(results.value("descriptives", Json::array()), "cells");
  lists.emplace_back("descriptives", descriptives);
  lists.emplace_back("descriptives_answers", entries_of(descriptives, "distribution"));
  if (results.contains("roster")) lists.emplace_back("roster", results.at("roster").at("protocols"));
  const Json questions = entries_of(results.value("people", Json::array()), "questions");
  lists.emplace_back("people", questions);
  lists.emplace_back("people_groups", entries_of(questions, "groups"));
  lists.emplace_back("not_analysed", results.value("not_analysed", Json::array()));
  Json costs = results.value("costs", Json::array());
  lists.emplace_back("costs_sweep", sweep_lines(costs));
  for (Json& one : costs) one.erase("sweep");
  lists.emplace_back("costs", costs);
  if (results.contains("task1") && !results.at("task1").contains("refused")) {
    const Json& task = results.at("task1");
    for (const char* name :
         {"participant_means", "cells", "by_scene", "people", "comparisons", "omnibus", "retest"})
      lists.emplace_back(std::string("task1_") + name, task.at(name));
    for (const char* name : {"by_n_star", "reliability", "detectable"})
      lists.emplace_back(std::string("task1_") + name, task.value(name, Json::array()));
    lists.emplace_back("task1_distributions",
                       entries_of(task.value("distributions", Json::array()), "counts"));
    lists.emplace_back("task1_ordinal", entries_of(task.at("ordinal"), "effects"));
    lists.emplace_back("task1_mixed", entries_of(task.at("mixed"), "terms"));
    lists.emplace_back("task1_factors", task.value("factors", Json::array()));
  }
  if (results.contains("task2") && !results.at("task2").contains("refused")) {
    const Json& task = results.at("task2");
    for (const char* name : {"choices", "pairs", "by_scene"})
      lists.emplace_back(std::string("task2_") + name, task.at(name));
    if (task.at("bradley_terry").contains("abilities"))
      lists.emplace_back("task2_bradley_terry", task.at("bradley_terry").at("abilities"));
    lists.emplace_back("task2_triads", task.at("triads").at("participants"));
    lists.emplace_back("task2_factors", task.value("factors", Json::array()));
  }
  if (results.contains("sickness")) {
    const Json& parts = results.at("sickness");
    for (const auto& [name, place] : {std::pair{"ssq", "/ssq/scores"},
                                      {"fms_blocks", "/fms/blocks"},
                                      {"fms_times", "/fms/times"},
                                      {"participants", "/scores"}})
      lists.emplace_back(std::string("sickness_") + name, sickness_lines(parts, Json::json_pointer(place)));
  }
  write(folder / "exclusions.csv", csv_text(results.at("exclusions"), exclusion_columns));
  for (const auto& [name, list] : lists) {
    if (!list.empty()) write(folder / (name + ".csv"), csv_text(list));
  }
}

}  // namespace

std::vector<std::filesystem::path> csv_folders(const Json& results, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out{folder};
  for (std::size_t i = 0; i < results.value("apart", Json::array()).size(); ++i)
    out.push_back(folder / ("apart_" + std::to_string(i + 1)));
  return out;
}

void write_csv_folder(const Json& results, const std::filesystem::path& folder, const WriteFile& write) {
  const auto folders = csv_folders(results, folder);
  write_document(results, folder, write);
  for (std::size_t i = 1; i < folders.size(); ++i)
    write_document(results.at("apart").at(i - 1), folders[i], write);
}

}  // namespace study
