#include "libstudy/analysis/timing_predictors.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "libstudy/pacing/pacer.hpp"
#include "stats/base/error.hpp"
#include "stats/fps_window.hpp"
#include "stats/quantiles.hpp"

namespace study {

namespace {

struct PredictorNames {
  const char* name;
  const char* words;
};
constexpr std::array<PredictorNames, timing_predictor_count> predictor_table{{
    {"mean_rate", "log of the harmonic mean of the frame rate"},
    {"arithmetic_rate", "log of the arithmetic mean of the frame rate"},
    {"rate_sd", "standard deviation of the frame rate, frames/s"},
    {"frame_time_sd", "standard deviation of the frame time, ms"},
    {"p95", "log(1000 / 95th percentile of the frame time in ms)"},
    {"p99", "log(1000 / 99th percentile of the frame time in ms)"},
    {"longest", "log(1000 / longest frame time in ms)"},
    {"hitches", "log(1 + number of frame times above 1.5 medians)"},
    {"steps", "log(1 + root mean square difference of successive frame times in ms)"},
    {"animation_error", "log(1 + mean absolute difference of simulated and shown steps in ms)"},
}};

constexpr const char* ptpe_model = "ptpe";

std::string known_models() {
  std::string out = ptpe_model;
  for (const auto& one : predictor_table) out += std::string(", ") + one.name;
  return out;
}

TimingPredictor predictor_of(const std::string& name, const std::string& option) {
  for (std::size_t i = 0; i < predictor_table.size(); ++i)
    if (name == predictor_table[i].name) return static_cast<TimingPredictor>(i);
  throw base::Error(option, "'" + name + "' is no model",
                    "write names of " + known_models() +
                        ", separated by commas, or two of them other than ptpe joined by '+'");
}

TimingModel model_of(const std::string& name, const std::string& option) {
  if (name == ptpe_model) return {name, {TimingPredictor::MeanRate, TimingPredictor::RateSd}};
  TimingModel out{name, {}};
  std::istringstream parts(name + "+");
  for (std::string part; std::getline(parts, part, '+');)
    out.predictors.push_back(predictor_of(part, option));
  if (out.predictors.empty()) predictor_of("", option);
  if (out.predictors.size() > 2)
    throw base::Error(option, "'" + name + "' joins more than two predictors", "join two of them by '+'");
  if (out.predictors.size() == 2 && out.predictors[0] == out.predictors[1])
    throw base::Error(option, "'" + name + "' joins a predictor with itself",
                      "join two different ones by '+'");
  return out;
}

}  // namespace

TimingPredictors timing_predictors(std::span<const double> intervals_s,
                                   std::optional<double> animation_error_ms) {
  const auto moments = stats::fps_moments(intervals_s);
  if (moments.frames == 0)
    throw std::invalid_argument("timing_predictors: no interval; give the times of at least one frame");
  std::vector<double> sorted;
  double squares = 0, steps = 0;
  const double n = static_cast<double>(moments.frames), mean_ms = 1000 / moments.mean;
  for (std::size_t i = 0; i < intervals_s.size(); ++i) {
    const double ms = 1000 * intervals_s[i];
    sorted.push_back(ms);
    squares += (ms - mean_ms) * (ms - mean_ms);
    if (i > 0) steps += std::pow(ms - 1000 * intervals_s[i - 1], 2);
  }
  std::sort(sorted.begin(), sorted.end());
  const double hitch_ms = hitch_factor * stats::sorted_quantile(sorted, 0.5);
  const auto hitches = std::count_if(sorted.begin(), sorted.end(), [&](double ms) { return ms > hitch_ms; });
  TimingPredictors out{};
  const auto set = [&](TimingPredictor which, double value) { out[static_cast<std::size_t>(which)] = value; };
  set(TimingPredictor::MeanRate, std::log(moments.mean));
  set(TimingPredictor::ArithmeticRate, std::log(moments.mean_arithmetic));
  set(TimingPredictor::RateSd, moments.sd);
  set(TimingPredictor::FrameTimeSd, std::sqrt(squares / n));
  set(TimingPredictor::P95, std::log(1000 / stats::sorted_quantile(sorted, 0.95)));
  set(TimingPredictor::P99, std::log(1000 / stats::sorted_quantile(sorted, 0.99)));
  set(TimingPredictor::Longest, std::log(1000 / sorted.back()));
  set(TimingPredictor::Hitches, std::log1p(static_cast<double>(hitches)));
  set(TimingPredictor::Steps, n > 1 ? std::log1p(std::sqrt(steps / (n - 1))) : 0);
  set(TimingPredictor::AnimationError, animation_error_ms ? std::log1p(*animation_error_ms) : NAN);
  return out;
}

bool TimingModel::uses(TimingPredictor one) const {
  return std::find(predictors.begin(), predictors.end(), one) != predictors.end();
}

const char* predictor_name(TimingPredictor predictor) {
  return predictor_table[static_cast<std::size_t>(predictor)].name;
}
const char* predictor_words(TimingPredictor predictor) {
  return predictor_table[static_cast<std::size_t>(predictor)].words;
}

std::vector<TimingModel> usual_timing_models() {
  return parse_timing_models("ptpe,mean_rate,arithmetic_rate,frame_time_sd,p95,p99,longest,hitches");
}

std::vector<TimingModel> parse_timing_models(const std::string& text) {
  std::vector<std::string> list;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) list.push_back(name);
  return timing_models(list, "--models " + text);
}

std::vector<TimingModel> timing_models(const std::vector<std::string>& names, const std::string& place) {
  std::vector<TimingModel> out;
  for (const std::string& name : names) {
    auto model = model_of(name, place);
    for (const TimingModel& other : out)
      if (std::is_permutation(other.predictors.begin(), other.predictors.end(), model.predictors.begin(),
                              model.predictors.end()))
        throw base::Error(place,
                          "names the model '" + name + "' twice" +
                              (other.name == name ? "" : ", the first time as '" + other.name + "'"),
                          "name each model once");
    out.push_back(std::move(model));
  }
  if (out.size() < 2)
    throw base::Error(place, "names fewer than two models", "name at least two of " + known_models());
  return out;
}

bool contains(const TimingModel& wide, const TimingModel& narrow) {
  return wide.predictors.size() > narrow.predictors.size() && wide.predictors[0] == narrow.predictors[0];
}

}  // namespace study
