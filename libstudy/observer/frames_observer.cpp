#include "libstudy/observer/frames_observer.hpp"

#include <array>
#include <cmath>

#include "libstudy/observer/specification.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

namespace {

constexpr std::string_view frames_kind = "frames";
const std::string frames_mend = "write frames, or frames with parameters such as frames:grain=4,bias=0.3";
constexpr double neutral_granularity_px = 8.5, neutral_flicker = 0.02, tau_scale = 15;
constexpr double symptom_level = 0.6, symptom_scale = 3;

std::array<ObserverKey, 9> keys_of(FramesObserverParameters& p) {
  constexpr double most = 100;
  return {{{"grain", &p.grain, 0, most},
           {"flicker", &p.flicker, 0, most},
           {"timing", &p.timing, 0, most},
           {"noise", &p.noise, 0, most},
           {"participant_sd", &p.participant_sd, 0, most},
           {"bias", &p.bias, -most, most},
           {"sickness", &p.sickness, 0, most},
           {"fatigue", &p.fatigue, 0, most},
           {"effects", &p.effects, -most, most}}};
}

}  // namespace

FramesObserverParameters parse_frames_observer(std::string_view specification) {
  FramesObserverParameters parameters;
  if (specification == frames_kind) return parameters;
  if (!specification.starts_with(std::string(frames_kind) + ":"))
    fail_observer(specification, 0, "is not a kind of observer", frames_mend);
  read_observer_keys(specification, frames_kind.size() + 1, keys_of(parameters), frames_mend);
  return parameters;
}

std::optional<std::string> FramesObserver::simulated() const {
  FramesObserverParameters copy = parameters_;
  return std::string(frames_kind) + ":" + write_observer_keys(written(keys_of(copy)));
}

double FramesObserver::quality(const ShownStimulus& shown) const {
  const PictureFeatures features = features_.of(shown.what.stimulus);
  const double tau = stats::ptpe_tolerance({}, shown.realised.mean, shown.realised.sd);
  return parameters_.timing * std::tanh(tau / tau_scale) -
         parameters_.grain * std::log2(features.granularity_px / neutral_granularity_px) -
         parameters_.flicker * std::log2(features.flicker / neutral_flicker) +
         (has_effects(shown.what.stimulus) ? parameters_.effects : 0);
}

int FramesObserver::symptom(const Question& question, const Occasion& occasion) const {
  const std::uint64_t key = question_key(occasion, question);
  double worst = -quality(occasion.shown.front());
  for (const ShownStimulus& shown : occasion.shown) worst = std::max(worst, -quality(shown));
  // One random number per participant shifts the scores of all symptoms alike.
  const double person = parameters_.participant_sd * normal_of(person_key(occasion), 1);
  const double noise =
      0.5 * parameters_.noise * normal_of(key, 1 + static_cast<std::uint64_t>(occasion.position));
  const double latent =
      symptom_level + parameters_.sickness * worst + parameters_.fatigue * occasion.position + person + noise;
  return nearest_score(question, latent * question.scale_max / symptom_scale);
}

int FramesObserver::score(const Question& question, const Occasion& occasion, bool judges) const {
  if (!occasion.shown.empty() && asks_symptom(question)) return symptom(question, occasion);
  if (!judges) return bystander_score(question, occasion);
  const double noise = parameters_.noise * normal_of(question_key(occasion, question),
                                                     1 + static_cast<std::uint64_t>(occasion.position));
  if (occasion.shown.size() == 2) {
    const auto scores = scores_of(question);
    const double better = quality(occasion.shown[1]) - quality(occasion.shown[0]);
    return better + parameters_.bias + noise > 0 ? scores.back() : scores.front();
  }
  const double person = parameters_.participant_sd * normal_of(person_key(occasion), 0);
  return rated_score(question, quality(occasion.shown[0]) + person + noise);
}

}  // namespace study
