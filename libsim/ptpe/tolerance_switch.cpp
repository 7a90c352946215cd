#include "libsim/ptpe/tolerance_switch.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "stats/base/error.hpp"

namespace sim {

std::optional<double> parse_tau(std::string_view text) {
  if (text == "live") return std::nullopt;
  constexpr std::string_view fixed = "fixed:";
  double value = 0;
  if (text.starts_with(fixed)) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + fixed.size(), end, value);
    if (error == std::errc() && rest == end && std::isfinite(value)) return value;
  }
  throw base::Error("tau \"" + std::string(text) + "\"", "is neither live nor fixed:X",
                    "write for example fixed:-6, in frames/s");
}

FrameRate parse_frame_rate(std::string_view text) {
  FrameRate rate;
  const char* end = text.data() + text.size();
  const auto [comma, error] = std::from_chars(text.data(), end, rate.mean);
  if (error == std::errc() && comma != end && *comma == ',') {
    const auto [rest, second] = std::from_chars(comma + 1, end, rate.sd);
    const bool finite = std::isfinite(rate.mean) && std::isfinite(rate.sd);
    if (second == std::errc() && rest == end && finite && rate.mean > 0 && rate.sd >= 0) return rate;
  }
  throw base::Error("frame rate \"" + std::string(text) + "\"", "is not a mean and a standard deviation",
                    "write for example 16.9,3.2, in frames/s");
}

ToleranceSwitch::ToleranceSwitch(const stats::PtpeModel& model, std::optional<double> fixed_tau,
                                 std::optional<FrameRate> fixed_rate)
    : model_(model), fixed_(fixed_tau || fixed_rate), rate_(fixed_rate) {
  if (fixed_tau && fixed_rate)
    throw base::Error("tau", "is given, and the frame rate that it follows from too", "give one of them");
  if (fixed_rate) fixed_tau = stats::ptpe_tolerance(model, fixed_rate->mean, fixed_rate->sd);
  if (!fixed_tau) return;
  if (!std::isfinite(*fixed_tau)) throw base::Error("tau", "is not finite", "give frames per second");
  set(*fixed_tau);
}

void ToleranceSwitch::frame_time(double ms) {
  if (fixed_) return;
  if (!(ms > 0) || !std::isfinite(ms)) {
    ++left_out_;
    return;
  }
  window_.push(1e-3 * ms);
  const stats::FpsMoments known = window_.moments();
  const double tau = stats::ptpe_tolerance(model_, known);
  rate_ = FrameRate{known.mean_of(model_.mean), known.sd};
  if (known.frames < window_frames) {
    tau_ = tau;
  } else {
    set(tau);
  }
}

double ToleranceSwitch::beta() const { return on_ ? stats::activation_floor(model_, *tau_) : 1; }

void ToleranceSwitch::set(double tau) {
  tau_ = tau;
  if (tau < 0) on_ = true;
  if (tau > off_above) on_ = false;
}

}  // namespace sim
