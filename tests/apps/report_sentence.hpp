#pragma once
/// A sentence of the report, with "#" for quoted values and "*" for any words, and changes of the results
/// that make it true and false.

#include <functional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace report_sentences {

using Json = base::Json;
using Change = std::function<void(Json&)>;

struct Case {
  std::string pattern;  ///< as for fnmatch()
  Change make_false;
  Change make_true = [](Json&) {};  ///< applied to a study with a pilot and both tasks, before make_false
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

/// The results' facts about a sweep.
inline Json sweep() {
  return {{"file", "sweep.db"},
          {"errors", {{"front_pct", "front, %"}}},
          {"left_out", {"Faucet has no reference"}}};
}
inline Json price() {
  return {{"machine", "a machine"},
          {"program", "0.1.0"},
          {"picture", "none"},
          {"seconds", 2},
          {"reference_n_star", 512},
          {"ms_mean", 3.5},
          {"ms_p95", 4.5},
          {"times_hires", 1.25},
          {"errors", {{"front_pct", {{"mean", 0.5}, {"low", 0.25}, {"high", 0.75}}}}}};
}
inline const Change with_sweep =
    all({set("/sweep", sweep()), in_each("/costs", "sweep", Json::array({price()}))});
inline const Change without_sweep = [](Json& json) {
  json.erase("sweep");
  for (auto& one : json["costs"]) one.erase("sweep");
};

inline const Change by_holm = set("/plan/decision", "holm");

}  // namespace report_sentences
