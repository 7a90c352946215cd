#include "libstudy/analysis/rivals/proposals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "libstudy/pacing/schedule.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_proposals = 6;
constexpr int most_of_a_profile = 2;
constexpr std::uint64_t proposal_seed = 1;
constexpr double correlation = 0.8;  ///< of neighbouring frames, in correlated candidates
constexpr double block_s = 0.5;      ///< for which a rate of an alternating trace lasts

struct Candidate {
  TimingProfile profile;
  FrameOrder order = FrameOrder::White;
};

std::vector<double> alternating_ms(double first_fps, double second_fps) {
  std::vector<double> out;
  for (const double fps : {first_fps, second_fps})
    out.insert(out.end(), static_cast<std::size_t>(std::lround(block_s * fps)), std::round(1e6 / fps) / 1000);
  return out;
}

std::vector<Candidate> candidates(bool order_matters, bool error_matters) {
  std::vector<Candidate> out;
  for (const double fps : {15, 20, 25, 30, 40, 50, 60}) {
    for (const double hitch_ms : {100, 150, 200, 250, 400}) {
      for (const double period_s : {0.5, 1.0, 2.0, 5.0})
        out.push_back(
            {{.kind = ProfileKind::Hitches, .mean_fps = fps, .hitch_ms = hitch_ms, .period_s = period_s}});
    }
    for (const double low : {4, 6, 8, 10, 15, 20})
      if (low < fps) out.push_back({{.kind = ProfileKind::Floor, .mean_fps = fps, .low_fps = low}});
    for (const double slow : {8, 10, 12, 20})
      if (slow < fps) out.push_back({{.kind = ProfileKind::Trace, .frame_ms = alternating_ms(slow, fps)}});
    for (const double sd : {0.0, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0}) {
      if (sd >= fps) continue;
      const TimingProfile profile{.kind = ProfileKind::Moments, .mean_fps = fps, .sd_fps = sd};
      out.push_back({profile});
      if (order_matters && sd > 0) out.push_back({profile, FrameOrder::Ar1});
      for (const double error_ms : {5.0, 10.0, 20.0, 40.0}) {
        if (!error_matters) break;
        out.push_back({profile});
        out.back().profile.animation_error_ms = error_ms;
      }
    }
  }
  return out;
}

std::string timing_keys(const TimingProfile& profile) {
  switch (profile.kind) {
    case ProfileKind::Hitches:
      return fmt::format("base_fps = {:g}, hitch_ms = {:g}, period_s = {:g}", profile.mean_fps,
                         profile.hitch_ms, profile.period_s);
    case ProfileKind::Floor:
      return fmt::format("mean_fps = {:g}, low_fps = {:g}", profile.mean_fps, profile.low_fps);
    case ProfileKind::Trace:
      return fmt::format("frame_ms = [{:g}]", fmt::join(profile.frame_ms, ", "));
    case ProfileKind::Moments:
      break;
  }
  return fmt::format("mean_fps = {:g}, sd_fps = {:g}", profile.mean_fps, profile.sd_fps) +
         (profile.animation_error_ms > 0
              ? fmt::format(", animation_error_ms = {:g}", profile.animation_error_ms)
              : "");
}

/// The words of a candidate: a trace by its two rates, since its words otherwise are a hash.
std::string words_of(const Candidate& candidate) {
  const TimingProfile& profile = candidate.profile;
  if (profile.kind == ProfileKind::Trace)
    return fmt::format("{:g} and {:g} frames/s in turn, {:g} s each",
                       std::round(1000 / profile.frame_ms.front()),
                       std::round(1000 / profile.frame_ms.back()), block_s);
  const bool correlated = candidate.order == FrameOrder::Ar1;
  return profile_text(profile) +
         (correlated ? fmt::format(", neighbours correlated by {:g}", correlation) : "");
}

/// The predictors' ranges over the answers, widened by a rounding error.
struct Shown {
  TimingPredictors low{}, high{};

  explicit Shown(const std::vector<TimingPredictors>& timing) : low(timing.front()), high(timing.front()) {
    for (const auto& one : timing) {
      for (std::size_t i = 0; i < one.size(); ++i) {
        low[i] = std::min(low[i], one[i]);
        high[i] = std::max(high[i], one[i]);
      }
    }
  }
  /// True if the model's predictors, the mean rate and the longest frame time lie within what was shown.
  bool holds(const TimingPredictors& at, const TimingModel& model) const {
    auto all = model.predictors;
    all.insert(all.end(), {TimingPredictor::MeanRate, TimingPredictor::Longest});
    return std::all_of(all.begin(), all.end(), [&](TimingPredictor p) {
      const auto i = static_cast<std::size_t>(p);
      const double slack = 1e-3 * (high[i] - low[i]);
      return at[i] >= low[i] - slack && at[i] <= high[i] + slack;
    });
  }
};

/// The Jensen-Shannon divergence of distributions with equal weights, nats.
double divergence(const std::vector<std::vector<double>>& all) {
  double sum = 0;
  const double n = static_cast<double>(all.size());
  for (std::size_t c = 0; c < all.front().size(); ++c) {
    double mean = 0;
    for (const auto& one : all) mean += one[c] / n;
    for (const auto& one : all)
      if (one[c] > 0) sum += one[c] / n * std::log(one[c] / mean);
  }
  return std::max(0.0, sum);
}

/// Predicts the answers at a timing. False if a model would be extrapolated.
bool predict(const TimingPredictors& at, const Shown& shown, const std::vector<FittedModel>& models,
             const std::vector<int>& scores, Proposal& out) {
  std::vector<std::vector<double>> all;
  for (const FittedModel& one : models) {
    if (!shown.holds(at, *one.model)) return false;
    std::vector<double> values;
    for (std::size_t j = 0; j < one.model->predictors.size(); ++j) values.push_back(one.model->value(at, j));
    all.push_back(one.fitter->probabilities(*one.fit, values));
    out.scores.push_back(0);
    for (std::size_t c = 0; c < scores.size(); ++c) out.scores.back() += all.back()[c] * scores[c];
  }
  out.information = divergence(all);
  return true;
}

}  // namespace

Proposals propose_timings(const RivalData& data, const std::vector<FittedModel>& models) {
  Proposals out;
  const Shown shown(data.timing);
  const auto scores = scores_of(data.task.question);
  const auto matters = [&](TimingPredictor predictor) {
    return std::any_of(models.begin(), models.end(),
                       [&](const FittedModel& one) { return one.model->uses(predictor); });
  };
  std::vector<std::pair<Proposal, ProfileKind>> all;
  for (const Candidate& candidate :
       candidates(matters(TimingPredictor::Steps), matters(TimingPredictor::AnimationError))) {
    Proposal one;
    try {
      const FpsSetting setting = setting_of(candidate.profile, data.settings.front().duration_s);
      PacingRules rules;
      rules.order = candidate.order;
      rules.ar1 = candidate.order == FrameOrder::Ar1 ? correlation : 0;
      const auto at = timing_predictors(compile_schedule(setting, rules, proposal_seed).intervals_s,
                                        candidate.profile.animation_error_ms);
      ++out.tried;
      if (!predict(at, shown, models, scores, one)) {
        ++out.beyond;
        continue;
      }
    } catch (const base::Error&) {
      continue;  // the numbers of this candidate do not make a timing of this length
    }
    one.words = words_of(candidate);
    one.timing = std::string("timing = {profile = \"") + profile_word(candidate.profile.kind) + "\", " +
                 timing_keys(candidate.profile) + "}";
    if (candidate.order == FrameOrder::Ar1)
      one.pacing = fmt::format("order = \"ar1\", ar1 = {:g}", correlation);
    all.emplace_back(std::move(one), candidate.profile.kind);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first.information > b.first.information; });
  std::map<ProfileKind, int> taken;
  for (auto& [one, kind] : all)
    if (out.best.size() < most_proposals && ++taken[kind] <= most_of_a_profile)
      out.best.push_back(std::move(one));
  return out;
}

}  // namespace study
