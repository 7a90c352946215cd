#include "libstudy/observer/ptpe_observer.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "libstudy/design/random.hpp"
#include "stats/base/error.hpp"
#include "stats/ptpe.hpp"

namespace study {

namespace {

constexpr std::string_view kind = "ptpe:";
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Key {
  std::string_view name;
  double PtpeObserverParameters::*member;
  double min, max;
  bool open_min;  ///< the minimum itself is out of range
  bool required;
};

constexpr std::array keys{
    Key{"a", &PtpeObserverParameters::a, 0, infinity, true, true},
    Key{"b", &PtpeObserverParameters::b, -1, 1, false, true},
    Key{"slope", &PtpeObserverParameters::slope, 0, infinity, true, false},
    Key{"noise", &PtpeObserverParameters::noise, 0, infinity, false, false},
    Key{"participant_sd", &PtpeObserverParameters::participant_sd, 0, infinity, false, false},
};

[[noreturn]] void fail(std::string_view specification, std::size_t at, const std::string& problem) {
  throw base::Error("observer '" + std::string(specification) + "', character " + std::to_string(at + 1),
                    problem, "write ptpe:a=31,b=0.035 with slope, noise and participant_sd as you like");
}

double parse_value(std::string_view specification, std::size_t at, const Key& key, std::string_view text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail(specification, at, "'" + std::string(text) + "' is not a number");
  }
  if (value < key.min || value > key.max || (key.open_min && value == key.min)) {
    fail(specification, at, std::string(key.name) + " = " + std::string(text) + " is out of range");
  }
  return value;
}

/// Uniform in (0, 1).
double uniform(std::uint64_t key, std::uint64_t counter) {
  return (static_cast<double>(counter_random(key, counter) >> 11) + 0.5) * 0x1p-53;
}

/// Standard normal number `counter` of a key (Box and Muller 1958).
double normal(std::uint64_t key, std::uint64_t counter) {
  const double radius = std::sqrt(-2 * std::log(uniform(key, 2 * counter)));
  return radius * std::cos(2 * std::numbers::pi * uniform(key, 2 * counter + 1));
}

std::uint64_t person_key(std::uint64_t seed, const std::string& participant) {
  return random_key("observer\n" + std::to_string(seed) + '\n' + participant);
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

PtpeObserverParameters parse_ptpe_observer(std::string_view specification) {
  if (!specification.starts_with(kind)) fail(specification, 0, "is not a kind of observer");
  PtpeObserverParameters parameters;
  std::array<bool, keys.size()> given{};
  std::size_t at = kind.size();
  while (at <= specification.size()) {
    const std::size_t end = std::min(specification.find(',', at), specification.size());
    const std::string_view pair = specification.substr(at, end - at);
    const std::size_t equals = pair.find('=');
    if (equals == std::string_view::npos) fail(specification, at, "expected key=number");
    std::size_t index = 0;
    while (index < keys.size() && keys[index].name != pair.substr(0, equals)) ++index;
    if (index == keys.size())
      fail(specification, at, "unknown key '" + std::string(pair.substr(0, equals)) + "'");
    if (given[index]) fail(specification, at, "key '" + std::string(keys[index].name) + "' is given twice");
    given[index] = true;
    parameters.*keys[index].member =
        parse_value(specification, at + equals + 1, keys[index], pair.substr(equals + 1));
    at = end + 1;
  }
  for (std::size_t index = 0; index < keys.size(); ++index) {
    if (keys[index].required && !given[index]) {
      fail(specification, specification.size(), "key '" + std::string(keys[index].name) + "' is missing");
    }
  }
  return parameters;
}

std::optional<std::string> PtpeObserver::simulated() const {
  std::string text(kind);
  for (const Key& key : keys) {
    if (text.size() > kind.size()) text += ',';
    text += std::string(key.name) + "=" + shortest(parameters_.*key.member);
  }
  return text;
}

Answer PtpeObserver::answer(const Question& question, const ShownTrial& trial, Clock&) {
  const std::uint64_t key = person_key(trial.seed, trial.participant);
  const double tau =
      stats::ptpe_tolerance({parameters_.a, parameters_.b}, trial.realised.mean, trial.realised.sd);
  const double midpoint = 0.5 * (question.scale_min + question.scale_max);
  const double latent = midpoint + parameters_.slope * tau + parameters_.participant_sd * normal(key, 0) +
                        parameters_.noise * normal(key, 1 + static_cast<std::uint64_t>(trial.position));
  // Counting the thresholds below x needs no clamp at the ends of the scale.
  int score = question.scale_min;
  while (score < question.scale_max && latent > score + 0.5) ++score;
  return {score};
}

}  // namespace study
