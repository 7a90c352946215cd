#include "libstudy/analysis/rivals/compare_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libstudy/analysis/rivals/proposals.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr const char* nothing_model = "nothing";  ///< the model without a predictor

int reference_of(const std::vector<stats::RivalModel>& models) {
  return models.back().name == free_model ? static_cast<int>(models.size()) - 1 : -1;
}

/// The values of a column, averaged over the answers to each setting.
std::vector<double> by_setting(const RivalData& data, const std::vector<double>& column) {
  std::vector<double> sum(data.settings.size()), n(data.settings.size());
  for (std::size_t i = 0; i < column.size(); ++i) {
    sum[static_cast<std::size_t>(data.setting[i])] += column[i];
    n[static_cast<std::size_t>(data.setting[i])] += 1;
  }
  for (std::size_t s = 0; s < sum.size(); ++s) sum[s] /= n[s];
  return sum;
}

class Document {
 public:
  Document(const RivalData& data, const std::vector<TimingModel>& models,
           const stats::RivalComparisonOptions& options, const stats::RivalComparison& comparison,
           const PlanInForce& plan, const std::string& exploratory)
      : data_(data),
        plan_(plan),
        exploratory_(exploratory),
        models_(models),
        options_(options),
        comparison_(comparison),
        rivals_(rival_models(data, models)),
        scores_(scores_of(data.task.question)) {
    for (const auto& one : rivals_) fitters_.emplace_back(one, data.answers, options.fit);
  }

  Json json() const {
    Json json{{"schema", "vip-compare-models/1"},
              {"version", base::version()},
              {"date_utc", base::utc_now()},
              {"exploratory", !exploratory_.empty()},
              {"why_exploratory", exploratory_},
              {"plan", plan_json(plan_, {data_.task.protocol.sha256})},
              {"protocol", {{"name", data_.task.protocol.name}, {"sha256", data_.task.protocol.sha256}}},
              {"question", data_.task.question.id},
              {"people", comparison_.people},
              {"answers", comparison_.answers},
              {"settings", data_.settings.size()},
              {"test_data", data_.task.test_data},
              {"simulated_participants", data_.task.simulated.size()},
              {"left_out", left_out()},
              {"folds", options_.folds == 0 ? comparison_.people : options_.folds},
              {"seed", options_.seed},
              {"models", Json::array()},
              {"collinear", collinear()}};
    json["plan"].erase("preregistered");  // the entry "preregistration" says it for the bundle
    for (const int m : comparison_.order) json["models"].push_back(model_json(m));
    for (std::size_t m = 0; m < comparison_.models.size(); ++m)
      if (!comparison_.models[m].fit)
        json["models"].push_back(
            {{"name", name(static_cast<int>(m))}, {"refused", comparison_.models[m].fit.reason()}});
    json["verdict"] = verdict_json();
    json["proposals"] = proposals_json();
    return json;
  }

 private:
  const stats::RivalScore& score(int m) const { return comparison_.models[static_cast<std::size_t>(m)]; }
  const std::string& name(int m) const { return score(m).name; }
  bool is_timing(int m) const { return m < static_cast<int>(models_.size()); }
  int best_rival() const { return comparison_.in_the_running.front(); }

  Json left_out() const {
    int excluded = 0;
    for (const auto& one : data_.task.exclusions) excluded += one.answers;
    return {{"excluded", excluded},
            {"without_frames", data_.without_frames},
            {"sessions_of_test_data", data_.task.flow.test_left_out},
            {"sessions_simulated", data_.task.flow.simulated_left_out}};
  }

  Json model_json(int m) const {
    const auto& one = score(m);
    Json json{{"name", one.name},
              {"log_score", one.total},
              {"behind", one.behind},
              {"behind_se", one.behind_se},
              {"in_the_running",
               std::count(comparison_.in_the_running.begin(), comparison_.in_the_running.end(), m) > 0},
              {"parameters", one.fit->parameters},
              {"sd_person", one.fit->sd_person},
              {"lapse", one.fit->lapse},
              {"log_likelihood", one.fit->log_likelihood},
              {"calibration", calibration(m)}};
    if (one.name != free_model) json["weight"] = one.weight;
    if (!is_timing(m)) return json;
    json["predictors"] = Json::array();
    for (const TimingPredictor p : models_[static_cast<std::size_t>(m)].predictors)
      json["predictors"].push_back({{"name", predictor_name(p)}, {"words", predictor_words(p)}});
    json["k"] = one.fit->coefficients[0];
    json["q"] = one.fit->coefficients[1];
    const auto ratios = fitters_[static_cast<std::size_t>(m)].ratios(*one.fit);
    if (!ratios.empty()) json["b"] = ratios.front();
    return json;
  }

  /// Answers by the score that the model predicts for them, rounded to the nearest score: their number, the
  /// mean prediction, the mean answer, and the standard error of the difference over people.
  Json calibration(int m) const {
    Json out = Json::array();
    std::vector<std::vector<std::size_t>> bins(scores_.size());
    std::vector<double> expected(comparison_.answers);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      for (std::size_t c = 0; c < scores_.size(); ++c)
        expected[i] += score(m).probabilities[i][c] * scores_[c];
      const auto nearest = std::min_element(scores_.begin(), scores_.end(), [&](int a, int b) {
        return std::abs(a - expected[i]) < std::abs(b - expected[i]);
      });
      bins[static_cast<std::size_t>(nearest - scores_.begin())].push_back(i);
    }
    for (std::size_t c = 0; c < bins.size(); ++c) {
      if (bins[c].empty()) continue;
      const double n = static_cast<double>(bins[c].size());
      double predicted = 0, observed = 0, squares = 0;
      std::vector<double> by_person(data_.participants.size());
      for (const std::size_t i : bins[c]) {
        predicted += expected[i] / n;
        observed += scores_[static_cast<std::size_t>(data_.answers.score[i])] / n;
      }
      for (const std::size_t i : bins[c])
        by_person[static_cast<std::size_t>(data_.answers.person[i])] +=
            scores_[static_cast<std::size_t>(data_.answers.score[i])] - expected[i] - (observed - predicted);
      for (const double sum : by_person) squares += sum * sum;
      const double people = static_cast<double>(by_person.size());
      out.push_back({{"score", scores_[c]},
                     {"answers", bins[c].size()},
                     {"predicted", predicted},
                     {"observed", observed},
                     {"se", std::sqrt(squares * people / (people - 1)) / n}});
    }
    return out;
  }

  /// For each pair of timing models: how well the second can imitate the predictor of the first over the
  /// shown settings.
  Json collinear() const {
    Json out = Json::array();
    for (const int a : comparison_.order) {
      if (!is_timing(a)) continue;
      const auto v = by_setting(data_, fitters_[static_cast<std::size_t>(a)].combined(*score(a).fit));
      for (const int b : comparison_.order) {
        if (a == b || !is_timing(b)) continue;
        std::vector<std::vector<double>> columns;
        for (const auto& p : rivals_[static_cast<std::size_t>(b)].predictors)
          columns.push_back(by_setting(data_, p.values));
        out.push_back(
            {{"predictor_of", name(a)}, {"by", name(b)}, {"r2", stats::imitated_share(v, columns)}});
      }
    }
    return out;
  }

  std::string difference_words(double difference, double se) const {
    return fmt::format("{:.1f} +- {:.1f}", difference, se);
  }

  std::string winner_words() const {
    const int second = *std::find_if(comparison_.order.begin(), comparison_.order.end(),
                                     [&](int m) { return m != best_rival() && name(m) != free_model; });
    return fmt::format(
        "{} predicts the answers best. It leads every rival by more than two standard errors; the "
        "nearest is {}, {} behind",
        name(best_rival()), name(second), difference_words(-score(second).behind, score(second).behind_se));
  }

  std::string open_words() const {
    const auto lead = stats::rival_lead(comparison_.models.back().by_person, score(best_rival()).by_person);
    return fmt::format(
        "{} leads every rival by more than two standard errors, but a free value for each setting predicts "
        "better still, by {}. Whether {} describes the answers is open",
        name(best_rival()), difference_words(lead.difference, lead.se), name(best_rival()));
  }

  std::string undecided_words() const {
    if (comparison_.in_the_running.size() == 1) return open_words();
    std::vector<std::string> names;
    std::string nested;
    for (const int m : comparison_.in_the_running) {
      names.push_back(name(m));
      for (const int inner : comparison_.in_the_running)
        if (m != inner && includes(m, inner)) nested += "; " + name(m) + " contains " + name(inner);
    }
    return "these answers cannot tell apart " + base::joined(names) +
           ": the first has the best score, but leads the " +
           "others by no more than two standard errors, or by no more than " +
           base::shortest(stats::RivalLead::least_lead) + nested;
  }

  /// True if the model m with some coefficients of 0 is the model `inner`.
  bool includes(int m, int inner) const {
    if (!is_timing(m)) return false;
    if (!is_timing(inner)) return true;
    return contains(models_[static_cast<std::size_t>(m)], models_[static_cast<std::size_t>(inner)]);
  }

  /// A sentence for answers that the model of nothing predicts as well as the rivals; else empty.
  std::string nothing_words() const {
    const auto& running = comparison_.in_the_running;
    const auto nothing = static_cast<int>(models_.size());
    if (std::find(running.begin(), running.end(), nothing) == running.end()) return "";
    return ". No model predicts the answers clearly better than the average answer (nothing) does";
  }

  /// Whether the model that the plan expects is the winner; adds "expected" and "confirmed" to the verdict.
  std::string expected_words(Json& verdict) const {
    if (!exploratory_.empty() || plan_.plan.comparison->expected.empty()) return "";
    const std::string& expected = plan_.plan.comparison->expected;
    const bool confirmed =
        comparison_.verdict == stats::RivalVerdict::Winner && name(best_rival()) == expected;
    verdict["expected"] = expected;
    verdict["confirmed"] = confirmed;
    return ". The plan expects " + expected + ": " + (confirmed ? "confirmed" : "not confirmed");
  }

  Json verdict_json() const {
    Json names = Json::array();
    for (const int m : comparison_.in_the_running) names.push_back(name(m));
    Json out{{"in_the_running", names}};
    switch (comparison_.verdict) {
      case stats::RivalVerdict::Winner:
        out["kind"] = "winner";
        out["text"] = winner_words();
        break;
      case stats::RivalVerdict::Undecided:
        out["kind"] = "undecided";
        out["text"] = undecided_words();
        break;
      case stats::RivalVerdict::NoneFits: {
        const auto lead =
            stats::rival_lead(comparison_.models.back().by_person, score(best_rival()).by_person);
        out["kind"] = "none_fits";
        out["text"] = fmt::format(
            "no model describes the answers: a free value for each setting predicts better "
            "than the best of them, {}, by {}. People notice something else, or more than "
            "one thing",
            name(best_rival()), difference_words(lead.difference, lead.se));
        break;
      }
    }
    out["text"] = out["text"].get<std::string>() + nothing_words() + expected_words(out);
    return out;
  }

  /// The timing models between which the proposals decide: those in the running; of one alone also the next
  /// best.
  std::vector<int> to_decide() const {
    std::vector<int> out;
    for (const int m : comparison_.in_the_running)
      if (is_timing(m)) out.push_back(m);
    for (const int m : comparison_.order)
      if (out.size() < 2 && is_timing(m) && std::count(out.begin(), out.end(), m) == 0) out.push_back(m);
    return out;
  }

  Json proposals_json() const {
    std::vector<FittedModel> models;
    Json out{{"between", Json::array()}, {"timings", Json::array()}};
    for (const int m : to_decide()) {
      const auto at = static_cast<std::size_t>(m);
      models.push_back({&models_[at], &fitters_[at], &*score(m).fit});
      out["between"].push_back(name(m));
    }
    if (models.size() < 2) return out;
    const Proposals found = propose_timings(data_, models);
    out["tried"] = found.tried;
    out["beyond_what_was_shown"] = found.beyond;
    for (const Proposal& one : found.best) {
      Json json{{"words", one.words},
                {"timing", one.timing},
                {"information", one.information},
                {"scores", one.scores}};
      if (!one.pacing.empty()) json["pacing"] = one.pacing;
      out["timings"].push_back(json);
    }
    return out;
  }

  const RivalData& data_;
  const PlanInForce& plan_;
  const std::string& exploratory_;
  const std::vector<TimingModel>& models_;
  const stats::RivalComparisonOptions& options_;
  const stats::RivalComparison& comparison_;
  std::vector<stats::RivalModel> rivals_;
  std::vector<stats::RivalFitter> fitters_;
  std::vector<int> scores_;
};

}  // namespace

std::vector<stats::RivalModel> rival_models(const RivalData& data, const std::vector<TimingModel>& models) {
  std::vector<stats::RivalModel> out;
  for (const TimingModel& model : models) {
    stats::RivalModel& one = out.emplace_back(stats::RivalModel{model.name, {}, false});
    for (std::size_t j = 0; j < model.predictors.size(); ++j) {
      one.predictors.push_back({predictor_name(model.predictors[j]), {}});
      for (const auto& timing : data.timing) one.predictors.back().values.push_back(model.value(timing, j));
    }
  }
  out.push_back({nothing_model, {}, true});
  if (data.settings.size() > most_free_settings) return out;
  stats::RivalModel free{free_model, {}, true};
  for (std::size_t s = 1; s < data.settings.size(); ++s) {
    free.predictors.push_back({setting_name(data.settings[s]), {}});
    for (const int at : data.setting) free.predictors.back().values.push_back(at == static_cast<int>(s));
  }
  out.push_back(std::move(free));
  return out;
}

stats::Result<stats::RivalComparison> compare_timing_models(const RivalData& data,
                                                            const std::vector<TimingModel>& models,
                                                            const stats::RivalComparisonOptions& options,
                                                            const RivalFits* without) {
  const auto rivals = rival_models(data, models);
  return stats::compare_rivals(rivals, data.answers, reference_of(rivals), options, without);
}

std::string why_exploratory(const RivalData& data, const std::vector<TimingModel>& models,
                            const stats::RivalComparisonOptions& options, bool plan_rules,
                            const PlanInForce& plan, const std::optional<FrozenFacts>& frozen) {
  if (!plan.plan.comparison) return no_declared_comparison;
  const stats::DeclaredComparison& declared = *plan.plan.comparison;
  std::set<std::string> names;
  for (const TimingModel& one : models) names.insert(one.name);
  std::vector<std::string> other;
  if (data.task.question.id != declared.question) other.emplace_back("question");
  if (names != std::set<std::string>(declared.models.begin(), declared.models.end()))
    other.emplace_back("models");
  if (options.folds != declared.folds) other.emplace_back("groups of people");
  if (!plan_rules) other.emplace_back("rules of exclusion or seed");
  if (!other.empty()) return plan.source + " declares other " + base::enumerated(other);
  if (!frozen)
    return plan.source +
           " declares this comparison, but nothing shows that it is older than the data (--preregistered "
           "reads a "
           "preregistration)";
  const Json found = preregistration_json(*frozen, data.task);
  return found.at("preregistered").get<bool>() ? ""
                                               : plan.source + " declares this comparison, but " +
                                                     found.at("problems").at(0).get<std::string>();
}

Json compare_models_json(const RivalData& data, const std::vector<TimingModel>& models,
                         const stats::RivalComparisonOptions& options,
                         const stats::RivalComparison& comparison, const PlanInForce& plan,
                         const std::string& exploratory) {
  return Document(data, models, options, comparison, plan, exploratory).json();
}

}  // namespace study
