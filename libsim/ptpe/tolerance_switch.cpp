#include "libsim/ptpe/tolerance_switch.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim {

std::optional<double> parse_tau(std::string_view text) {
  if (text == "live") return std::nullopt;
  constexpr std::string_view fixed = "fixed:";
  if (text.starts_with(fixed)) {
    const auto value = base::parse_number<double>(text.substr(fixed.size()));
    if (value && std::isfinite(*value)) return value;
  }
  throw base::Error("tau \"" + std::string(text) + "\"", "is neither live nor fixed:X with a finite number X",
                    "write live, or for example fixed:-6, in frames/s");
}

FrameRate parse_frame_rate(std::string_view text) {
  if (const auto comma = text.find(','); comma != std::string_view::npos) {
    const auto mean = base::parse_number<double>(text.substr(0, comma));
    const auto sd = base::parse_number<double>(text.substr(comma + 1));
    if (mean && sd && std::isfinite(*mean) && std::isfinite(*sd) && *mean > 0 && *sd >= 0)
      return {*mean, *sd};
  }
  throw base::Error("frame rate \"" + std::string(text) + "\"",
                    "is not a mean above 0 and a standard deviation from 0 on, with a comma between",
                    "write for example 16.9,3.2, in frames/s");
}

ToleranceSwitch::ToleranceSwitch(const stats::PtpeModel& model, std::optional<double> fixed_tau,
                                 std::optional<FrameRate> fixed_rate)
    : model_(model), fixed_(fixed_tau || fixed_rate), rate_(fixed_rate) {
  if (fixed_tau && fixed_rate)
    throw base::Error("tau", "is given together with a frame rate, from which it would be computed",
                      "give only tau, or only the frame rate");
  if (fixed_rate) fixed_tau = stats::ptpe_tolerance(model, fixed_rate->mean, fixed_rate->sd);
  if (!fixed_tau) return;
  if (!std::isfinite(*fixed_tau))
    throw base::Error("tau = " + std::to_string(*fixed_tau), "is not finite",
                      fixed_rate ? "give a finite frame rate with a smaller standard deviation"
                                 : "give a finite number of frames/s");
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
