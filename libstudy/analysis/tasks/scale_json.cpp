#include "libstudy/analysis/tasks/scale_json.hpp"

#include <algorithm>
#include <map>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/gsl_errors.hpp"
#include "stats/preference/next_pairs.hpp"

namespace study {

namespace {

/// At most this many conditions are named in a message.
constexpr std::size_t most_named = 12;

std::string set_words(const ScaleGroup& group, const std::vector<int>& set) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < set.size() && i < most_named; ++i)
    words.push_back(base::shortened(group.conditions[static_cast<std::size_t>(set[i])], 60));
  if (set.size() > most_named) words.push_back(std::to_string(set.size() - most_named) + " more");
  return "{" + base::joined(words) + "}";
}

[[noreturn]] void refuse_unlinked(const std::string& place, const ScaleGroup& group,
                                  const std::vector<std::vector<int>>& parts) {
  std::vector<std::string> sets;
  for (std::size_t i = 0; i < parts.size() && i < most_named; ++i) sets.push_back(set_words(group, parts[i]));
  if (parts.size() > most_named) sets.push_back(std::to_string(parts.size() - most_named) + " more parts");
  const auto name = [&](std::size_t part) {
    return base::shortened(group.conditions[static_cast<std::size_t>(parts[part].front())], 60);
  };
  throw base::Error(place,
                    "the conditions fall into " + std::to_string(parts.size()) +
                        " parts that no answer links: " + base::enumerated(sets),
                    "ask pairs across the parts, such as " + name(0) + " with " + name(1) +
                        ", or give only the answers to one part");
}

/// The first two conditions that were rated.
std::string rated_pair(const ScaleGroup& group) {
  std::vector<int> rated;
  for (const stats::RatingCount& one : group.data.ratings)
    if (std::find(rated.begin(), rated.end(), one.condition) == rated.end()) rated.push_back(one.condition);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < rated.size() && i < 2; ++i)
    words.push_back(base::shortened(group.conditions[static_cast<std::size_t>(rated[i])], 60));
  return words.size() < 2 ? "one" : "one, such as " + words[0] + " with " + words[1];
}

/// The remedy for a reason why quality_scale() refuses.
std::string mend_of(const std::string& reason, const ScaleGroup& group, const stats::ScaleOptions& options) {
  if (reason == stats::no_order_bias) return "show pairs in both orders, or leave --order-bias out";
  if (reason == stats::no_common_unit)
    return "ask choices between rated conditions, at least " + rated_pair(group) +
           ", or leave the ratings out";
  return options.prior != stats::ScalePrior::Normal
             ? "give --prior normal, which holds the scale with a weak prior, or ask more people"
             : "give more answers, or fewer conditions";
}

stats::QualityScale fitted(const std::string& place, const ScaleGroup& group,
                           const stats::ScaleOptions& options) {
  const auto parts = stats::linked_groups(group.data);
  if (parts.size() > 1) refuse_unlinked(place, group, parts);
  const auto scale = stats::quality_scale(group.data, options);
  if (scale) return *scale;
  const std::string reason = with_names(scale.reason(), group.conditions);
  if (group.data.pairs.empty())
    throw base::Error(place, "there is " + reason,
                      "add choices between two conditions; vip-stats study and report describe ratings");
  const bool separated = reason.find("every comparison") != std::string::npos;
  throw base::Error(
      place, separated ? reason + ", so that its place on the scale has no bound" : "no scale: " + reason,
      mend_of(scale.reason(), group, options));
}

Json order_json(const stats::QualityScale& scale) {
  if (!scale.order_bias) return {};
  return {{"jod", *scale.order_bias}, {"se", json_number(scale.order_bias_se)}};
}

Json ratings_json(const stats::QualityScale& scale) {
  if (!scale.slope) return {};
  return {{"slope", *scale.slope},
          {"se", json_number(scale.slope_se)},
          {"scores", scale.levels},
          {"thresholds", scale.thresholds}};
}

Json conditions_json(const stats::QualityScale& scale, const ScaleGroup& group) {
  Json out = Json::array();
  for (std::size_t i = 0; i < group.conditions.size(); ++i) {
    Json one{{"condition", group.conditions[i]}, {"jod", scale.jod[i]}};
    const bool intervals = !scale.se.empty();
    one["se"] = intervals ? Json(scale.se[i]) : Json();
    one["se_sandwich"] = intervals ? Json(scale.se_sandwich[i]) : Json();
    one["ci"] = intervals ? json_interval(scale.ci[i]) : Json();
    out.push_back(one);
  }
  return out;
}

Json differences_json(const stats::QualityScale& scale, const ScaleGroup& group) {
  Json out = Json::array();
  for (const stats::ScaleDifference& one : scale.differences)
    out.push_back({{"a", group.conditions[static_cast<std::size_t>(one.i)]},
                   {"b", group.conditions[static_cast<std::size_t>(one.j)]},
                   {"jod", one.jod},
                   {"probability", one.probability},
                   {"se", json_number(one.se)},
                   {"ci", json_interval(one.ci)},
                   {"p", json_number(one.p)}});
  return out;
}

Json next_json(const stats::QualityScale& scale, const ScaleGroup& group, int count) {
  Json out = Json::array();
  for (const stats::NextPair& one : stats::next_pairs(scale.jod, scale.model_covariance, count))
    out.push_back({{"a", group.conditions[static_cast<std::size_t>(one.first)]},
                   {"b", group.conditions[static_cast<std::size_t>(one.second)]},
                   {"bits", one.bits},
                   {"probability", one.probability}});
  return out;
}

Json observers_json(std::vector<stats::ScaleObserver> observers, const std::vector<std::string>& people) {
  stats::score_observers(observers);
  Json out = Json::array();
  for (const stats::ScaleObserver& one : observers)
    out.push_back({{"person", people[static_cast<std::size_t>(one.person)]},
                   {"answers", one.answers},
                   {"log_likelihood", one.log_likelihood},
                   {"score", one.score},
                   {"score_per_answer", one.score_per_answer}});
  return out;
}

std::string why_no_intervals(const stats::QualityScale& scale, const ScaleTable& table,
                             const ScaleGroup& group) {
  const std::string reason = with_names(scale.why_no_intervals, group.conditions);
  if (!scale.without) return reason;
  return "without person " + base::shortened(table.people[static_cast<std::size_t>(*scale.without)], 60) +
         ": " + reason + "; --prior normal holds the scale";
}

}  // namespace

const char* prior_name(stats::ScalePrior prior) {
  return prior == stats::ScalePrior::None     ? "none"
         : prior == stats::ScalePrior::Normal ? "normal"
                                              : "bounded";
}

Json scale_json(const ScaleTable& table, const ScaleRequest& request) {
  Json scales = Json::array();
  // An observer's log-likelihood is summed over all scales, if each has intervals.
  std::map<int, stats::ScaleObserver> observers;
  bool complete = true;
  for (const ScaleGroup& group : table.groups) {
    const std::string place =
        group.name.empty() ? request.place : request.place + ", " + table.by + " " + group.name;
    const stats::QualityScale scale = fitted(place, group, request.options);
    const std::string why = why_no_intervals(scale, table, group);
    complete = complete && why.empty();
    for (const stats::ScaleObserver& one : scale.observers) {
      auto& sum = observers.try_emplace(one.person, stats::ScaleObserver{.person = one.person}).first->second;
      sum.answers += one.answers;
      sum.log_likelihood += one.log_likelihood;
      sum.log_probability += one.log_probability;
    }
    scales.push_back({{"name", group.name},
                      {"choices", scale.choices},
                      {"ratings", scale.ratings},
                      {"people", table.people_known ? Json(scale.people) : Json()},
                      {"why_no_intervals", why},
                      {"conditions", conditions_json(scale, group)},
                      {"differences", differences_json(scale, group)},
                      {"order_bias", order_json(scale)},
                      {"rating", ratings_json(scale)},
                      {"log_likelihood", scale.log_likelihood},
                      {"next", next_json(scale, group, request.next)}});
  }
  std::vector<stats::ScaleObserver> list;
  if (complete)
    for (const auto& [person, one] : observers) list.push_back(one);
  Json json{{"schema", "vip-scale/1"},
            {"versions", {{"vip_lab", base::version()}, {"gsl", stats::gsl_library_version()}}},
            {"date_utc", base::utc_now()},
            {"source", request.source},
            {"by", table.by.empty() ? Json() : Json(table.by)},
            {"unit", "JOD: a condition 1 JOD above another is chosen in 75 % of answers"},
            {"prior", prior_name(request.options.prior)},
            {"confidence", request.options.confidence},
            {"people_known", table.people_known},
            {"warnings", table.warnings},
            {"notes", table.notes},
            {"scales", scales},
            {"observers", observers_json(list, table.people)},
            {"why_no_observers", complete ? "" : "a scale has no intervals"}};
  if (!table.study.is_null()) {
    json["study"] = table.study;
    json["exclusions"] = table.exclusions;
  }
  return json;
}

}  // namespace study
