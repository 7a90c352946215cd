#pragma once
/// The display's refresh rate, as far as XR_FB_display_refresh_rate tells and changes it.

#include <optional>
#include <vector>

#include "apps/common/headset/session_handle.hpp"

namespace apps {

class RefreshControl {
 public:
  explicit RefreshControl(const SessionHandle& session);
  /// Hz, ascending; empty: the runtime does not say.
  const std::vector<double>& rates() const { return rates_; }
  /// The present rate. Only where several rates are listed: some runtimes answer with a rate that they do not
  /// have while they list one.
  std::optional<double> told_hz() const;
  /// Asks for a listed rate; the display takes it later, if at all. base::Error for a rate that is not
  /// listed.
  void request(double hz) const;

 private:
  const SessionHandle& session_;
  std::vector<double> rates_;
};

}  // namespace apps
