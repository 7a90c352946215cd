#pragma once
/// A sentence of the report, "#" for what it quotes and "*" for any words, with results in which it is true
/// and such in which it is false.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace report_sentences {

using Json = nlohmann::ordered_json;
using Change = std::function<void(Json&)>;

struct Case {
  std::string pattern;  ///< as fnmatch() takes it
  Change make_false;
  Change make_true = [](Json&) {};  ///< of a study with a pilot and both tasks, which comes first
};

inline Change set(const std::string& pointer, Json value) {
  return [=](Json& json) { json[Json::json_pointer(pointer)] = value; };
}
inline Change refused(const std::string& part) { return set(part, {{"refused", "no answer counts"}}); }
inline Change all(std::vector<Change> changes) {
  return [=](Json& json) {
    for (const auto& change : changes) change(json);
  };
}
inline Change in_each(const std::string& list, const std::string& key, Json value) {
  return [=](Json& json) {
    for (auto& one : json[Json::json_pointer(list)]) one[key] = value;
  };
}

inline Json bundle() {
  return {{"sha256", "ab"},
          {"frozen_utc", "2026-01-01T00:00:00Z"},
          {"vip_lab", "0.1.0"},
          {"summary", "Everything is as it was fixed."},
          {"tasks", {{"task1", true}, {"task2", false}}},
          {"times", {{{"task", "task1"}, {"text", "Frozen first."}}}},
          {"differences", {"protocol task2 was not preregistered"}}};
}

inline const Change by_holm = set("/plan/decision", "holm");

}  // namespace report_sentences
