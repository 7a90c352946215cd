#pragma once
/// Reads and changes the display's refresh rate through XR_FB_display_refresh_rate.

#include <optional>
#include <vector>

#include "libstudy/headset/session_handle.hpp"

namespace study {

class RefreshControl {
 public:
  explicit RefreshControl(const SessionHandle& session);
  /// The refresh rates that the runtime lists, Hz, ascending; empty: not reported.
  const std::vector<double>& rates() const { return rates_; }
  /// The current rate, Hz; none if no rate is listed. If one rate is listed, it is this one: some runtimes
  /// list one rate and report another.
  std::optional<double> reported_hz() const;
  /// Requests a listed rate, Hz; the display may change to it later, or never. base::Error for a rate that is
  /// not listed.
  void request(double hz) const;
  /// Requests a rate that request() accepted once more. A refusal is no error.
  void request_again(double hz) const;

 private:
  std::optional<double> listed_hz(double hz) const;
  XrResult ask(double hz) const;

  const SessionHandle& session_;
  std::vector<double> rates_;
};

}  // namespace study
