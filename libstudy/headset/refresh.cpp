#include "libstudy/headset/refresh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"

namespace study {

RefreshControl::RefreshControl(const SessionHandle& session) : session_(session) {
  if (!session.xr().has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) return;
  constexpr const char* call = "xrEnumerateDisplayRefreshRatesFB";
  for (const float rate : read_array<float>(call, 0.0f, [&](auto capacity, auto*count, auto*values) {
         return session.attempt<PFN_xrEnumerateDisplayRefreshRatesFB>(call, session.get(), capacity, count,
                                                                      values);
       }))
    rates_.push_back(static_cast<double>(rate));
  std::sort(rates_.begin(), rates_.end());
}

/// The listed rate that equals hz. Rates are listed as 32-bit floats, so 71.928 from a file is compared with
/// a tolerance.
std::optional<double> RefreshControl::listed_hz(double hz) const {
  const auto found =
      std::find_if(rates_.begin(), rates_.end(), [&](double rate) { return std::abs(rate - hz) < 0.01; });
  return found == rates_.end() ? std::nullopt : std::optional(*found);
}

std::optional<double> RefreshControl::reported_hz() const {
  if (rates_.empty()) return {};
  if (rates_.size() == 1) return rates_[0];
  float rate = 0;
  session_.call<PFN_xrGetDisplayRefreshRateFB>("xrGetDisplayRefreshRateFB", session_.get(), &rate);
  return static_cast<double>(rate);
}

XrResult RefreshControl::ask(double hz) const {
  return session_.attempt<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB", session_.get(),
                                                             static_cast<float>(hz));
}

void RefreshControl::request(double hz) const {
  if (const auto listed = listed_hz(hz)) return check_xr(ask(*listed), "xrRequestDisplayRefreshRateFB");
  throw base::Error(
      "headset", fmt::format("{:g} Hz is not one of its refresh rates", hz),
      "set refresh_hz of the protocol's [headset] to a rate that vip-study headset lists; if it lists "
      "none, remove refresh_hz");
}

void RefreshControl::request_again(double hz) const {
  if (const auto listed = listed_hz(hz)) ask(*listed);
}

}  // namespace study
