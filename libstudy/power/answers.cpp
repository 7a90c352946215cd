#include "libstudy/power/answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libstudy/base/random.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "stats/base/error.hpp"
#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

namespace {

constexpr int sickness_item_count = 4;
constexpr double rounding_variance = 1.0 / 12;
/// A study's key XOR this constant is the key of the random numbers for the interaction of person and method.
/// They are thus independent of the random numbers for persons and trials. Each method uses two of them.
constexpr std::uint64_t by_method_key = 0x6d6574686f64;

/// Random numbers of one participant, by index: 0 to 9 are those of the person, 10 to 19 those of the trial
/// at position 0, 20 to 29 those of the trial at position 1, and so on.
class Draws {
 public:
  Draws(std::uint64_t key, int participant)
      : key_(counter_random(key, static_cast<std::uint64_t>(participant))) {}
  double person(int which) const { return normal_of(key_, static_cast<std::uint64_t>(which)); }
  double normal(const ShownTrial& trial, int which) const { return normal_of(key_, counter(trial, which)); }
  double uniform(const ShownTrial& trial, int which) const { return uniform_of(key_, counter(trial, which)); }

 private:
  /// Index of a trial's random number.
  static std::uint64_t counter(const ShownTrial& trial, int which) {
    return 10 * (static_cast<std::uint64_t>(trial.position) + 1) + static_cast<std::uint64_t>(which);
  }
  std::uint64_t key_;
};

const Question& question(const Protocol& protocol, const char* id) {
  for (const auto& [block, one] : all_questions(protocol)) {
    if (one->id == id) return *one;
  }
  throw base::Error("protocol " + protocol.name, "does not ask \"" + std::string(id) + "\"",
                    "use a protocol of Task 1");
}

double latent_variance(const char* option, double wanted, double rounding) {
  if (wanted >= rounding) return wanted - rounding;
  throw base::Error(
      option,
      "is too small: rounding to whole scores and --person-by-method alone give a person's answers a larger "
      "standard deviation",
      "give a larger value, a smaller --person-by-method, or --answers continuous");
}

double answer(const Task1Scatter& scatter, double latent, double low, double high) {
  if (scatter.answers == AnswerScale::Continuous) return latent;
  return std::clamp(std::round(latent), low, high);
}

double choose_first(double preferred, double bias) {
  return 1 / (1 + (1 - preferred) / preferred * std::exp(bias));
}

}  // namespace

Task1Scatter task1_scatter(const PowerRequest& request) {
  Task1Scatter out;
  out.answers = request.answers;
  const double rounding = request.answers == AnswerScale::Likert ? rounding_variance : 0;
  const double realism = request.sd_realism * request.sd_realism / 2;
  const double sickness = request.sd_sickness * request.sd_sickness / 2;
  out.participant_realism = Task1Scatter::participant_share * request.sd_realism;
  out.participant_sickness = Task1Scatter::participant_share * request.sd_sickness;
  const double method_realism = request.person_by_method.realism * realism;
  const double method_sickness = request.person_by_method.sickness * sickness;
  out.method_realism = std::sqrt(method_realism);
  out.method_sickness = std::sqrt(method_sickness);
  out.noise_realism = std::sqrt(latent_variance("--sd", realism - method_realism, rounding));
  // Half of the variance `sickness` goes to the single items. The other half goes to the interaction of
  // person and method and to the report as a whole. If the interaction needs more than this half, the items
  // get less.
  const double report = std::max(sickness / 2 - method_sickness, 0.0);
  out.noise_sickness = std::sqrt(report);
  out.noise_item = std::sqrt(
      latent_variance("--sd-sickness", sickness - method_sickness - report, rounding / sickness_item_count) *
      sickness_item_count);
  const auto& scale = question(request.protocol, "realism");
  const auto& item = question(request.protocol, "dizziness");
  out.realism_min = scale.scale_min;
  out.realism_max = scale.scale_max;
  out.item_min = item.scale_min;
  out.item_max = item.scale_max;
  return out;
}

Task1Answers answer_task1(std::span<const ShownTrial> trials, const ShownFactors& factors,
                          const Scenario& truth, const Task1Scatter& scatter, std::uint64_t key) {
  Task1Answers out;
  out.realism.reserve(trials.size());
  out.sickness.reserve(trials.size());
  for (const auto& trial : trials) {
    const auto& place = factors.cells[static_cast<std::size_t>(trial.first)];
    const auto cell = static_cast<std::size_t>(place.n_star) * factors.methods.size() +
                      static_cast<std::size_t>(place.method);
    const Draws draws(key, trial.participant), by_method(key ^ by_method_key, trial.participant);
    const double realism = truth.realism[cell] + scatter.participant_realism * draws.person(0) +
                           scatter.method_realism * by_method.person(2 * place.method) +
                           scatter.noise_realism * draws.normal(trial, 0);
    const double report = truth.sickness[cell] + scatter.participant_sickness * draws.person(1) +
                          scatter.method_sickness * by_method.person(2 * place.method + 1) +
                          scatter.noise_sickness * draws.normal(trial, 1);
    double sickness = 0;
    for (int item = 0; item < sickness_item_count; ++item) {
      const double latent = report + scatter.noise_item * draws.normal(trial, 2 + item);
      sickness += answer(scatter, latent, scatter.item_min, scatter.item_max);
    }
    out.realism.push_back({trial.participant, place.scene, place.n_star, place.method,
                           answer(scatter, realism, scatter.realism_min, scatter.realism_max), 1,
                           trial.position, trial.period});
    out.sickness.push_back({trial.participant, place.scene, place.n_star, place.method, sickness,
                            sickness_item_count, trial.position, trial.period});
  }
  return out;
}

std::vector<stats::PairChoice> answer_task2(std::span<const ShownTrial> trials, const ShownFactors& factors,
                                            const Scenario& truth, double interval_bias, std::uint64_t key) {
  std::vector<stats::PairChoice> out;
  out.reserve(trials.size());
  for (const auto& trial : trials) {
    const auto& first = factors.cells[static_cast<std::size_t>(trial.first)];
    const auto& second = factors.cells[static_cast<std::size_t>(trial.second)];
    const double preferred = truth.preferred[static_cast<std::size_t>(first.method) * factors.methods.size() +
                                             static_cast<std::size_t>(second.method)];
    const Draws draws(key, trial.participant);
    out.push_back({trial.participant, first.scene, first.method, second.method,
                   draws.uniform(trial, 0) < choose_first(preferred, interval_bias), trial.position});
  }
  return out;
}

std::vector<RealisedSetting> realised_settings(const Protocol& protocol) {
  std::vector<RealisedSetting> out;
  for (const auto& cell : protocol.design.cells) {
    const auto schedule = compile_schedule(cell.setting, for_display(protocol.pacing, 0), 1);
    const auto moments = stats::fps_moments(schedule.intervals_s);
    out.push_back({cell.setting.mean, cell.setting.sd, moments.mean, moments.mean_arithmetic, moments.sd});
  }
  return out;
}

std::vector<stats::PilotRating> answer_pilot(std::span<const ShownTrial> trials,
                                             std::span<const RealisedSetting> settings,
                                             const PtpeObserverParameters& observer, const RatedScale& scale,
                                             std::uint64_t key) {
  std::vector<stats::PilotRating> out;
  out.reserve(trials.size());
  for (const auto& trial : trials) {
    const auto& seen = settings[static_cast<std::size_t>(trial.first)];
    const Draws draws(key, trial.participant);
    const double tau = stats::ptpe_tolerance({observer.a, observer.b}, seen.harmonic, seen.sd);
    const double latent = scale.level + observer.slope * tau + observer.participant_sd * draws.person(0) +
                          observer.noise * draws.normal(trial, 0);
    out.push_back({trial.participant, seen.mu, seen.delta, seen.harmonic, seen.arithmetic, seen.sd,
                   std::clamp(std::round(latent), 1.0 * scale.min, 1.0 * scale.max)});
  }
  return out;
}

}  // namespace study
