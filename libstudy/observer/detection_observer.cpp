#include "libstudy/observer/detection_observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libstudy/observer/specification.hpp"
#include "libstudy/protocol/procedure.hpp"
#include "stats/base/nearest.hpp"

namespace study {

namespace {

constexpr std::string_view detection_kind = "detect:";
const std::string detection_mend =
    "write detect:hitch_ms,threshold=60; shape, guess, lapse and spread are optional";

std::array<ObserverKey, 5> keys_of(DetectionParameters& p) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{{"threshold", &p.threshold, 0, infinity, true, true},
           {"shape", &p.shape, 0, infinity, true},
           {"guess", &p.guess, 0, 1},
           {"lapse", &p.lapse, 0, 1},
           {"spread", &p.spread, 0, 10}}};
}

double value_on(const std::string& axis, const ShownStimulus& shown) {
  const auto& profile = shown.what.setting.profile;
  return profile ? axis_value(*profile, axis).value_or(0) : 0;
}

}  // namespace

DetectionParameters parse_detection_observer(std::string_view specification) {
  DetectionParameters out;
  const std::size_t comma = std::min(specification.find(','), specification.size());
  out.axis = specification.substr(detection_kind.size(), comma - detection_kind.size());
  if (std::find(axis_keys().begin(), axis_keys().end(), out.axis) == axis_keys().end())
    fail_observer(specification, detection_kind.size(),
                  "'" + out.axis + "' is no key of a timing profile whose number can be detected",
                  base::use_one_of(out.axis, axis_keys()));
  if (comma == specification.size())
    fail_observer(specification, comma, "key 'threshold' is missing", detection_mend);
  read_observer_keys(specification, comma + 1, keys_of(out), detection_mend);
  return out;
}

std::optional<std::string> DetectionObserver::simulated() const {
  DetectionParameters copy = parameters_;
  return std::string(detection_kind) + copy.axis + "," + write_observer_keys(keys_of(copy));
}

double DetectionObserver::detection(const Occasion& occasion, double x) const {
  const double t = parameters_.threshold * std::exp(parameters_.spread * normal_of(person_key(occasion), 0));
  return x > 0 ? (1 - parameters_.lapse) * -std::expm1(-std::pow(x / t, parameters_.shape)) : 0;
}

int DetectionObserver::score(const Question& question, const Occasion& occasion, bool judges) const {
  if (!judges) return bystander_score(question, occasion);
  const std::uint64_t key = question_key(occasion, question);
  const auto draw = [&](std::uint64_t number) {
    return uniform_of(key, (static_cast<std::uint64_t>(occasion.position) << 8) + number);
  };
  const auto scores = scores_of(question);
  const double first = value_on(parameters_.axis, occasion.shown.front());
  if (occasion.shown.size() == 1)
    return draw(0) < detection(occasion, first) || draw(1) < parameters_.guess ? scores.back()
                                                                               : scores.front();
  const double second = value_on(parameters_.axis, occasion.shown[1]);
  const bool detected = draw(0) < detection(occasion, std::max(first, second));
  const bool chose_first = detected && first != second ? first < second : draw(1) < 0.5;
  return chose_first ? scores.front() : scores.back();
}

}  // namespace study
