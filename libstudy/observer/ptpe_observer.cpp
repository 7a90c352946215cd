#include "libstudy/observer/ptpe_observer.hpp"

#include <array>
#include <limits>

#include "libstudy/observer/specification.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

namespace {

constexpr std::string_view ptpe_kind = "ptpe:";
const std::string ptpe_mend =
    "write ptpe:a=31,b=0.035; slope, noise, participant_sd and effects are optional";

std::array<ObserverKey, 6> keys_of(PtpeObserverParameters& p) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{{"a", &p.a, 0, infinity, true, true},
           {"b", &p.b, -1, 1, false, true},
           {"slope", &p.slope, 0, infinity, true},
           {"noise", &p.noise, 0, infinity},
           {"participant_sd", &p.participant_sd, 0, infinity},
           {"effects", &p.effects, -infinity, infinity}}};
}

}  // namespace

PtpeObserverParameters parse_ptpe_observer(std::string_view specification) {
  if (!specification.starts_with(ptpe_kind))
    fail_observer(specification, 0, "is not a kind of observer", ptpe_mend);
  PtpeObserverParameters parameters;
  read_observer_keys(specification, ptpe_kind.size(), keys_of(parameters), ptpe_mend);
  return parameters;
}

std::optional<std::string> PtpeObserver::simulated() const {
  PtpeObserverParameters copy = parameters_;
  return std::string(ptpe_kind) + write_observer_keys(written(keys_of(copy)));
}

/// Latent satisfaction x of one stimulus minus the scale's midpoint m; see PtpeObserverParameters.
double PtpeObserver::latent(const Occasion& occasion, std::size_t interval) const {
  const std::uint64_t key = person_key(occasion);
  const stats::FpsMoments& seen = occasion.shown[interval].realised;
  const double tau = stats::ptpe_tolerance({parameters_.a, parameters_.b}, seen.mean, seen.sd);
  const auto draw = (interval << 32) + 1 + static_cast<std::uint64_t>(occasion.position);
  const double effects = has_effects(occasion.shown[interval].what.stimulus) ? parameters_.effects : 0;
  return parameters_.slope * tau + effects + parameters_.participant_sd * normal_of(key, 0) +
         parameters_.noise * normal_of(key, draw);
}

int PtpeObserver::score(const Question& question, const Occasion& occasion, bool judges) const {
  if (!judges) return bystander_score(question, occasion);
  if (occasion.shown.size() == 2) {
    const auto scores = scores_of(question);
    return latent(occasion, 1) > latent(occasion, 0) ? scores.back() : scores.front();
  }
  return rated_score(question, latent(occasion, 0));
}

}  // namespace study
