#include "libstudy/pacing/exact_rates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "libstudy/pacing/truncated_normal.hpp"
#include "stats/base/error.hpp"
#include "stats/root.hpp"

namespace study {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double arithmetic_mean(const std::vector<double>& values) {
  long double sum = 0;
  for (const double value : values) sum += value;
  return static_cast<double>(sum / static_cast<long double>(values.size()));
}

double population_sd(const std::vector<double>& values) {
  const long double mean = arithmetic_mean(values);
  long double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return static_cast<double>(std::sqrt(squares / static_cast<long double>(values.size())));
}

/// A setting for which rates are sought, and the bounds of these rates.
struct Problem {
  FpsSetting setting;
  FpsMean mean;
  double low = 0;          // lowest rate, frames/s
  double high = infinity;  // highest rate, frames/s
  std::size_t n = 0;

  double mean_of(const std::vector<double>& rates) const { return mean_rate(rates, mean); }

  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    throw base::Error(
        fmt::format("setting {} over {:.4g} s ({} frames)", setting_name(setting), setting.duration_s, n),
        problem, mend);
  }
};

/// The root of `excess` between low and high. Fails if `excess` has the same sign at both ends: the moments
/// then differ too little for double precision.
double root_of(const Problem& problem, const std::function<double(double)>& excess, double low, double high) {
  try {
    return stats::find_root(excess, low, high);
  } catch (const std::invalid_argument&) {
    problem.fail(
        "no list of frame rates was found that has this mean and sd",
        fmt::format(
            "use an sd of 0 or of at least {:.4g} frames/s, and a mean further from fps_min and fps_max",
            least_sd_fps));
  }
}

/// Frame rates low + scale * y. y: distance from the lower bound in standard deviations of the parent normal.
std::vector<double> scaled(const Problem& problem, std::vector<double> strata, double scale) {
  for (double& y : strata) y = problem.low + scale * y;
  return strata;
}

/// Rates of a setting without an upper bound. The scale follows from the standard deviation in closed form.
/// The search is over `cut`, the lower bound in standard deviations from the mean of the untruncated (parent)
/// normal: the rates' mean falls monotonically as `cut` rises.
std::vector<double> solve_open(const Problem& problem) {
  const double sd = problem.setting.sd;
  const auto rates = [&](double cut) {
    auto strata = truncated_normal_strata(cut, infinity, problem.n);
    const double scale = sd / population_sd(strata);
    return scaled(problem, std::move(strata), scale);
  };
  const auto excess = [&](double cut) { return problem.mean_of(rates(cut)) - problem.setting.mean; };
  // With the parent mean this many standard deviations below the bound, the distribution is practically
  // exponential.
  const double exponential = 1e4;
  const double bell = -10 * (problem.setting.mean + sd) / sd;
  if (excess(exponential) > 0) {
    const double least = problem.setting.mean + excess(exponential);
    problem.fail(fmt::format("no truncated normal above {:.4g} frames/s has this mean and sd: with sd {:.4g} "
                             "the mean is at least {:.4g}",
                             problem.low, sd, least),
                 "lower fps_min and raise max_interval_ms, lengthen the trial, or lower the sd");
  }
  return rates(root_of(problem, excess, bell, exponential));
}

/// Rates with the requested mean. The range from low to high spans `width` standard deviations of the
/// untruncated (parent) normal.
std::vector<double> with_mean(const Problem& problem, double width) {
  const double scale = (problem.high - problem.low) / width;
  const auto rates = [&](double cut) {
    return scaled(problem, truncated_normal_strata(cut, width, problem.n), scale);
  };
  const auto excess = [&](double cut) { return problem.mean_of(rates(cut)) - problem.setting.mean; };
  double reach = width + 4 / width;
  while (reach < 1e7 / width + 10 * width &&
         (excess(-0.5 * width - reach) < 0 || excess(-0.5 * width + reach) > 0))
    reach *= 2;
  const double left = -0.5 * width - reach, right = -0.5 * width + reach;
  if (excess(left) < 0 || excess(right) > 0) {
    problem.fail(
        fmt::format(
            "the mean is too near the lowest or highest rate ({:.4g} and {:.4g} frames/s) for so few frames",
            problem.low, problem.high),
        "lower fps_min and raise max_interval_ms, raise fps_max, or lengthen the trial");
  }
  return rates(root_of(problem, excess, left, right));
}

/// Rates of a setting with an upper bound. The search is over `width`, the range from low to high in standard
/// deviations of the untruncated (parent) normal: the rates' standard deviation falls as `width` grows.
std::vector<double> solve_capped(const Problem& problem) {
  const auto excess = [&](double log_width) {
    return population_sd(with_mean(problem, std::exp(log_width))) - problem.setting.sd;
  };
  const double flat = std::log(1e-2);
  const double narrow = std::log(20 * (problem.high - problem.low) / problem.setting.sd);
  if (excess(flat) < 0) {
    problem.fail(fmt::format("no truncated normal between {:.4g} and {:.4g} frames/s has this mean and sd: "
                             "at this mean the sd is at most {:.4g}",
                             problem.low, problem.high, problem.setting.sd + excess(flat)),
                 "raise fps_max, lower fps_min and raise max_interval_ms, or lower the sd");
  }
  return with_mean(problem, std::exp(root_of(problem, excess, flat, narrow)));
}

void check_constant(const Problem& problem) {
  if (problem.setting.mean >= problem.low && problem.setting.mean <= problem.high) return;
  problem.fail(fmt::format("a constant {:.4g} frames/s lies outside {:.4g} to {:.4g} frames/s",
                           problem.setting.mean, problem.low, problem.high),
               "lower fps_min and raise max_interval_ms, or raise fps_max");
}

/// Keeps the rates that exact_rates() found, because each session of a study asks for the same ones again.
/// The key holds all numbers of a problem: mean, standard deviation, lowest and highest rate, kind of mean
/// and number of rates.
class Solutions {
 public:
  std::optional<std::vector<double>> find(const Problem& problem) {
    const std::lock_guard guard(turn_);
    const auto at = known_.find(key_of(problem));
    return at == known_.end() ? std::nullopt : std::optional(at->second);
  }
  void keep(const Problem& problem, const std::vector<double>& rates) {
    const std::lock_guard guard(turn_);
    if (known_.size() >= most) known_.clear();
    known_[key_of(problem)] = rates;
  }

 private:
  using Key = std::array<std::uint64_t, 6>;
  static constexpr std::size_t most = 1000;
  static Key key_of(const Problem& problem) {
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    return {bits(problem.setting.mean),
            bits(problem.setting.sd),
            bits(problem.low),
            bits(problem.high),
            static_cast<std::uint64_t>(problem.mean),
            problem.n};
  }

  std::mutex turn_;
  std::map<Key, std::vector<double>> known_;
};

}  // namespace

double mean_rate(const std::vector<double>& rates, FpsMean mean) {
  if (mean == FpsMean::Arithmetic) return arithmetic_mean(rates);
  long double time = 0;
  for (const double rate : rates) time += 1.0L / rate;
  return static_cast<double>(static_cast<long double>(rates.size()) / time);
}

std::vector<double> exact_rates(const FpsSetting& setting, const PacingRules& rules) {
  Problem problem{setting, rules.mean, std::max(rules.fps_min, 1000 / rules.max_interval_ms),
                  rules.fps_max.value_or(infinity), static_cast<std::size_t>(frame_count(setting))};
  if (setting.sd == 0) {
    check_constant(problem);
    return std::vector<double>(problem.n, setting.mean);
  }
  if (problem.n < 2) problem.fail("one frame has no standard deviation", "lengthen the trial");
  if (setting.mean <= problem.low || setting.mean >= problem.high) {
    problem.fail(
        fmt::format("the mean is not between the lowest rate {:.4g} and the highest rate {:.4g} frames/s",
                    problem.low, problem.high),
        "lower fps_min and raise max_interval_ms, or raise fps_max");
  }
  static Solutions solutions;
  if (const auto known = solutions.find(problem)) return *known;
  auto rates = std::isfinite(problem.high) ? solve_capped(problem) : solve_open(problem);
  const double mean_error = std::abs(problem.mean_of(rates) / setting.mean - 1);
  const double sd_error = std::abs(population_sd(rates) / setting.sd - 1);
  if (!(mean_error <= 1e-9 && sd_error <= 1e-9)) {
    problem.fail(fmt::format("mean and sd were met only with a relative error of {:.4g}, more than 1e-9",
                             std::max(mean_error, sd_error)),
                 "choose a mean further from fps_min and fps_max, or another sd");
  }
  solutions.keep(problem, rates);
  return rates;
}

}  // namespace study
