#include "stats/figures/log_axis.hpp"

#include <cmath>

#include "stats/figures/text_table.hpp"

namespace figures {

double LogScale::share(double value) const { return std::log(value / low) / std::log(high / low); }

std::vector<double> log_ticks(double least, double most) {
  const bool powers_alone = most > 1000 * least;
  std::vector<double> out;
  for (double power = std::pow(10, std::floor(std::log10(least)));; power *= 10) {
    for (const double tick : {power, 2 * power, 5 * power}) {
      if (powers_alone && tick > power) continue;
      if (tick <= least) out.clear();
      out.push_back(tick);
      if (tick >= most && out.size() > 1) return out;
    }
  }
}

std::string tick_label(double tick) { return tick < 1 ? shortest(tick) : number(tick, 0); }

}  // namespace figures
