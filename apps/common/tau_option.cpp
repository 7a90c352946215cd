#include "apps/common/tau_option.hpp"

#include <charconv>
#include <cmath>

#include "stats/base/error.hpp"

namespace apps {

std::optional<double> parse_tau(const std::string& word, const std::string& more) {
  if (word == "live") return {};
  const std::string start = "fixed:";
  if (word.rfind(start, 0) == 0) {
    double tau = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data() + start.size(), end, tau);
    if (error == std::errc() && rest == end && std::isfinite(tau)) return tau;
  }
  throw base::Error("--tau " + word, "is not known", "use live or fixed:-6" + more);
}

}  // namespace apps
