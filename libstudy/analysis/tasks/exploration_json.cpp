#include "libstudy/analysis/tasks/exploration_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "libstudy/analysis/tasks/task1_results.hpp"
#include "stats/inference/adjust.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/power.hpp"
#include "stats/inference/reliability.hpp"
#include "stats/inference/t_test.hpp"

namespace study {

namespace {

using Scores = std::vector<double>;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// The lowest score of each tenth of a visual analogue scale with more than 11 scores; for any other
/// question, every score.
std::vector<int> counted_scores(const Question& question) {
  const int range = question.scale_max - question.scale_min;
  if (!traits_of(question.kind).line || range <= 10) return scores_of(question);
  std::vector<int> out;
  for (int tenth = 0; tenth < 10; ++tenth) out.push_back(question.scale_min + (tenth * range + 9) / 10);
  return out;
}

/// Adds "n", the number of scores, and "counts": for each value of counted_scores(), the number of scores
/// from this value up to, but not including, the next value.
void add_counts(Json& json, const Question& question, const Scores& scores) {
  json["n"] = scores.size();
  json["counts"] = Json::array();
  const std::vector<int> lowest = counted_scores(question);
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    const auto counted = [&](double score) {
      return score >= lowest[i] && (i + 1 == lowest.size() || score < lowest[i + 1]);
    };
    json["counts"].push_back(
        {{"score", lowest[i]}, {"n", std::count_if(scores.begin(), scores.end(), counted)}});
  }
}

Json pilot_distributions(const TaskData& data) {
  std::map<std::pair<double, double>, Scores> settings;
  for (const auto& rating : data.ratings) settings[{rating.mu, rating.delta}].push_back(rating.score);
  Json list = Json::array();
  for (const auto& [setting, scores] : settings) {
    Json json{{"question", data.question.id}, {"fps_mean", setting.first}, {"fps_sd", setting.second}};
    add_counts(json, data.question, scores);
    list.push_back(std::move(json));
  }
  return list;
}

/// Mean answer of each participant to each item at one n_*; NaN without an answer. Row-major: the row is the
/// participant, the column the item.
Scores item_means(const TaskData& data, const std::vector<std::string>& items, int n_star) {
  const std::size_t k = items.size();
  Scores sums(data.participants.size() * k, 0.0), counts(sums.size(), 0.0);
  for (const Report& report : data.reports) {
    if (report.n_star != n_star) continue;
    for (std::size_t i = 0; i < k; ++i) {
      const auto answer = report.answers.find(items[i]);
      if (answer == report.answers.end()) continue;
      const std::size_t at = static_cast<std::size_t>(report.participant) * k + i;
      sums[at] += answer->second;
      counts[at] += 1;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = counts[i] > 0 ? sums[i] / counts[i] : missing;
  return sums;
}

/// Difference of methods a - b at the first n_* minus a - b at the second n_*, one value for each participant
/// with all four scores.
Scores double_differences(const stats::ScoreTable& table, std::pair<int, int> n_stars, int a, int b) {
  const auto a1 = table.column(n_stars.first, a), b1 = table.column(n_stars.first, b);
  const auto a2 = table.column(n_stars.second, a), b2 = table.column(n_stars.second, b);
  Scores out;
  for (std::size_t i = 0; i < a1.size(); ++i) {
    const double difference = (a1[i] - b1[i]) - (a2[i] - b2[i]);
    if (!std::isnan(difference)) out.push_back(difference);
  }
  return out;
}

/// Compares two n_*: adds one test for each pair of methods, corrected by Holm's method over these pairs.
void add_pair_of_n_stars(Json& list, const stats::ScoreTable& table, std::pair<int, int> n_stars,
                         const stats::AnalysisPlan& plan) {
  const auto name = [](const std::vector<std::string>& names, int i) { return names.at(std::size_t(i)); };
  const int methods = static_cast<int>(table.methods().size());
  Json family = Json::array();
  Scores p;
  for (int a = 0; a < methods; ++a) {
    for (int b = a + 1; b < methods; ++b) {
      const auto differences = double_differences(table, n_stars, a, b);
      const auto test = stats::t_test_one(differences, {stats::Alternative::TwoSided, plan.confidence, 0});
      Json json{{"score", table.scale().code},
                {"n_star", name(table.n_stars(), n_stars.first)},
                {"other_n_star", name(table.n_stars(), n_stars.second)},
                {"a", name(table.methods(), a)},
                {"b", name(table.methods(), b)},
                {"n", differences.size()},
                {"difference", test ? json_number(test->estimate) : Json()},
                {"ci", test ? json_interval(test->ci) : Json()},
                {"t", test ? json_number(test->t) : Json()},
                {"df", test ? json_number(test->df) : Json()},
                {"p", test ? json_number(test->p) : Json()},
                {"p_holm", Json()},
                {"reason", test.reason()}};
      p.push_back(test ? test->p : missing);
      family.push_back(std::move(json));
    }
  }
  const auto holm = stats::adjust(p, stats::Adjustment::Holm, p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (holm && !std::isnan(p[i])) family[i]["p_holm"] = holm->p[i];
    list.push_back(family[i]);
  }
}

/// Median, over the pairs of methods at this n_*, of the standard deviation of the participants' differences.
/// NaN if there are no such differences.
double median_sd(const stats::ScoreAnalysis& analysis, int n_star) {
  Scores sds;
  for (const auto& one : analysis.comparisons) {
    if (one.n_star == n_star && one.t) sds.push_back(one.t->sd_difference);
  }
  const auto described = stats::describe(sds);
  return described ? described->median : missing;
}

using Repeats = std::vector<std::array<double, 2>>;

double share_of_equals(const Repeats& repeats) {
  const auto equal =
      std::count_if(repeats.begin(), repeats.end(), [](const auto& one) { return one[0] == one[1]; });
  return static_cast<double>(equal) / static_cast<double>(repeats.size());
}

Json one_question(const std::string& question, const Repeats& repeats) {
  std::vector<double> before, after;
  double sum = 0, distance = 0;
  for (const auto& one : repeats) {
    before.push_back(one[0]);
    after.push_back(one[1]);
    sum += one[1] - one[0];
    distance += std::abs(one[1] - one[0]);
  }
  const auto n = static_cast<double>(repeats.size());
  const auto paired = stats::t_test_paired(before, after);
  return {{"score", question},
          {"pairs", repeats.size()},
          {"mean_difference", sum / n},
          {"mean_absolute_difference", distance / n},
          {"exact", share_of_equals(repeats)},
          {"correlation", paired ? json_number(paired->r) : Json()}};
}

}  // namespace

Json distributions_json(const TaskData& data) {
  if (data.task == TaskKind::Pilot) return pilot_distributions(data);
  Json list = Json::array();
  for (const auto& question : data.protocol.questions) {
    if (!traits_of(question.kind).rated()) continue;
    std::map<std::pair<int, int>, Scores> cells;  // n_*, method
    for (const Report& report : data.reports) {
      const auto answer = report.answers.find(question.id);
      if (answer != report.answers.end()) cells[{report.n_star, report.method}].push_back(answer->second);
    }
    for (const auto& [cell, scores] : cells) {
      Json json{{"question", question.id},
                {"n_star", data.protocol.n_stars[static_cast<std::size_t>(cell.first)]},
                {"method", data.protocol.methods[static_cast<std::size_t>(cell.second)]}};
      add_counts(json, question, scores);
      list.push_back(std::move(json));
    }
  }
  return list;
}

Json response_times_json(const TaskData& data) {
  Json list = Json::array();
  for (const auto& question : data.protocol.questions) {
    const auto found = data.response_times.find(question.id);
    if (found == data.response_times.end()) continue;
    const auto times = stats::describe(found->second);
    if (!times) continue;
    const bool measured = data.simulated.empty();
    const auto seconds = [&](const auto& value) { return measured ? json_number(value) : Json(); };
    list.push_back({{"task", task_name(data.task)},
                    {"question", question.id},
                    {"n", times->n},
                    {"mean", seconds(times->mean)},
                    {"sd", seconds(times->sd)},
                    {"median", seconds(times->median)},
                    {"q1", seconds(times->q25)},
                    {"q3", seconds(times->q75)},
                    {"min", seconds(times->min)},
                    {"max", seconds(times->max)},
                    {"reason", measured ? "" : "simulated participants take no time to answer"}});
  }
  return list;
}

Json reliability_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                      const stats::AnalysisPlan& plan) {
  Json list = Json::array();
  for (const auto& table : tables) {
    const auto& items = table.scale().items;
    if (items.size() < 2) continue;
    for (std::size_t n_star = 0; n_star < data.protocol.n_stars.size(); ++n_star) {
      const auto means = item_means(data, items, static_cast<int>(n_star));
      const auto alpha = stats::cronbach_alpha(means, static_cast<int>(items.size()), plan.confidence);
      Json json{{"score", table.scale().code},
                {"n_star", data.protocol.n_stars[n_star]},
                {"items", items.size()},
                {"n", alpha ? Json(alpha->n) : Json()},
                {"alpha", alpha ? Json(alpha->alpha) : Json()},
                {"ci", alpha ? json_interval(alpha->ci) : Json()},
                {"reason", alpha.reason()}};
      list.push_back(std::move(json));
    }
  }
  return list;
}

Json score_by_scene_json(const TaskData& data, const stats::ScoreTable& table, double confidence) {
  struct Cell {
    Scores reports;
    std::map<int, Scores> people;
  };
  std::map<std::tuple<int, int, int>, Cell> cells;
  for (const auto& score : report_scores(data, table.scale().items)) {
    if (std::isnan(score.sum)) continue;
    Cell& cell = cells[{score.n_star, score.scene, score.method}];
    cell.reports.push_back(score.value());
    cell.people[score.participant].push_back(score.value());
  }
  Json list = Json::array();
  for (const auto& [key, cell] : cells) {
    const auto& [n_star, scene, method] = key;
    Scores means;
    for (const auto& [person, values] : cell.people) means.push_back(stats::describe(values)->mean);
    const auto summary = stats::describe(cell.reports);
    const auto mean = stats::t_test_one(means, {stats::Alternative::TwoSided, confidence, 0});
    list.push_back({{"score", table.scale().code},
                    {"n_star", table.n_stars()[static_cast<std::size_t>(n_star)]},
                    {"scene", data.scenes[static_cast<std::size_t>(scene)]},
                    {"method", table.methods()[static_cast<std::size_t>(method)]},
                    {"n", cell.reports.size()},
                    {"mean", summary->mean},
                    {"sd", json_number(summary->sd)},
                    {"ci", mean ? json_interval(mean->ci) : Json()},
                    {"ci_reason", mean.reason()}});
  }
  return list;
}

Json n_star_differences_json(const std::vector<stats::ScoreTable>& tables, const stats::AnalysisPlan& plan) {
  Json list = Json::array();
  for (const auto& table : tables) {
    const int n_stars = static_cast<int>(table.n_stars().size());
    for (int i = 0; i < n_stars; ++i)
      for (int j = i + 1; j < n_stars; ++j) add_pair_of_n_stars(list, table, {i, j}, plan);
  }
  return list;
}

Json detectable_scores_json(const std::vector<stats::ScoreTable>& tables,
                            const std::vector<stats::ScoreAnalysis>& analyses,
                            const stats::AnalysisPlan& plan) {
  Json list = Json::array();
  for (std::size_t i = 0; i < tables.size(); ++i) {
    for (const auto& people : analyses[i].people) {
      const auto n = static_cast<double>(people.most);
      const auto d_z = stats::t_detectable(n, detectable_power, plan.alpha);
      const double sd = median_sd(analyses[i], people.n_star);
      list.push_back({{"score", tables[i].scale().code},
                      {"n_star", tables[i].n_stars()[static_cast<std::size_t>(people.n_star)]},
                      {"n", people.most},
                      {"power", detectable_power},
                      {"alpha", plan.alpha},
                      {"d_z", d_z ? Json(*d_z) : Json()},
                      {"sd_difference", json_number(sd)},
                      {"points", d_z ? json_number(*d_z * sd) : Json()},
                      {"reason", d_z.reason()}});
    }
  }
  return list;
}

Json detectable_preference_json(const stats::PreferenceAnalysis& analysis, const stats::AnalysisPlan& plan) {
  int n = 0;
  bool of_people = false;
  for (const auto& pair : analysis.pairs) {
    if (pair.test) n = std::max(n, static_cast<int>(pair.n));
    of_people = of_people || pair.shares;
  }
  auto share = stats::binomial_detectable(n, detectable_power, plan.alpha);
  if (n == 0 && of_people)
    share = stats::Refusal{
        "people answered a pair several times, and the power of the test of their shares depends on how "
        "alike one person's answers are"};
  return {{"n", n},
          {"power", detectable_power},
          {"alpha", plan.alpha},
          {"share", share ? Json(*share) : Json()},
          {"reason", share.reason()}};
}

Json rating_retest_json(const TaskData& data) {
  Json list = Json::array();
  for (const auto& [question, repeats] : data.repeats) list.push_back(one_question(question, repeats));
  return list;
}

Json choice_retest_json(const TaskData& data) {
  const auto found = data.repeats.find(data.question.id);
  if (found == data.repeats.end()) return {};
  return {{"pairs", found->second.size()}, {"same", share_of_equals(found->second)}};
}

}  // namespace study
