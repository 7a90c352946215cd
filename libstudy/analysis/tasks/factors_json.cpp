#include "libstudy/analysis/tasks/factors_json.hpp"

#include <algorithm>

#include "stats/analysis/factor_levels.hpp"

namespace study {

namespace {

/// The factor "effects" or "method": the names of its levels, and for each treatment (a method with a level
/// of effects) the index of its level of this factor and the index of its level of the second factor.
struct Factor {
  const char* name;
  std::vector<std::string> levels;
  std::vector<stats::FactorPlace> places;
};

void add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

/// The factors "effects" and "method", each only if it has several levels; empty if effects are not a factor.
std::vector<Factor> factors_of(const TaskProtocol& protocol) {
  if (protocol.effects.empty()) return {};
  Factor effects{"effects", {}, {}}, methods{"method", {}, {}};
  for (const auto& what : protocol.treatments) {
    add_once(effects.levels, what.effects);
    add_once(methods.levels, what.method);
  }
  for (const auto& what : protocol.treatments) {
    const int level = place_in(effects.levels, what.effects), method = place_in(methods.levels, what.method);
    effects.places.push_back({level, method});
    methods.places.push_back({method, level});
  }
  std::vector<Factor> out{effects, methods};
  std::erase_if(out, [](const Factor& one) { return one.levels.size() < 2; });
  return out;
}

const std::string& level(const Factor& factor, int index) {
  return factor.levels[static_cast<std::size_t>(index)];
}

/// A test of the mean of one value per participant: a t test, or an exact sign test if all values are equal.
Json t_test_json(const stats::Result<stats::OneSampleTTest>& test,
                 const std::optional<stats::Unanimous>& all_alike, const std::optional<double>& p,
                 const std::optional<double>& p_holm) {
  Json json{{"test", Json()}, {"mean", Json()}, {"ci", Json()}, {"t", Json()}, {"df", Json()}};
  if (test) {
    json = {{"test", "t test"},
            {"mean", test->mean},
            {"ci", json_interval(test->ci)},
            {"t", test->t},
            {"df", test->df}};
  } else if (all_alike) {
    json["test"] = "exact sign test";
    json["mean"] = all_alike->value;
  }
  json["p"] = json_number(p);
  json["p_holm"] = json_number(p_holm);
  json["reason"] = p ? "" : test.reason();
  return json;
}

}  // namespace

Json preference_factors_json(const TaskData& data, const stats::AnalysisPlan& plan) {
  Json list = Json::array();
  for (const Factor& factor : factors_of(data.protocol)) {
    for (const auto& one : stats::level_preferences(data.choices, factor.places,
                                                    static_cast<int>(factor.levels.size()), plan)) {
      Json json{{"factor", factor.name},
                {"a", level(factor, one.a)},
                {"b", level(factor, one.b)},
                {"participants", one.participants},
                {"n", one.n},
                {"k", one.k},
                {"share", one.n > 0 ? Json(1.0 * one.k / one.n) : Json()}};
      json.update(t_test_json(one.shares, one.all_alike, one.p(), one.p_holm));
      list.push_back(std::move(json));
    }
  }
  return list;
}

Json score_factors_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                        const stats::AnalysisPlan& plan) {
  Json list = Json::array();
  for (const Factor& factor : factors_of(data.protocol)) {
    for (const auto& table : tables) {
      for (const auto& one :
           stats::level_differences(table, factor.places, static_cast<int>(factor.levels.size()), plan)) {
        Json json{
            {"score", table.scale().code}, {"n_star", table.n_stars()[static_cast<std::size_t>(one.n_star)]},
            {"factor", factor.name},       {"a", level(factor, one.a)},
            {"b", level(factor, one.b)},   {"participants", one.participants}};
        json.update(t_test_json(one.difference, one.all_alike, one.p(), one.p_holm));
        list.push_back(std::move(json));
      }
    }
  }
  return list;
}

}  // namespace study
