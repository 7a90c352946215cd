#include "libsim/measure/pass_table.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "stats/base/json.hpp"
#include "stats/base/timing.hpp"

namespace measure {

void PassTable::add(std::span<const sim::PassTime> picture) {
  for (const sim::PassTime& time : picture) {
    const auto known = std::find_if(passes_.begin(), passes_.end(),
                                    [&](const Pass& pass) { return pass.name == time.pass; });
    Pass& pass = known == passes_.end() ? passes_.emplace_back(Pass{time.pass, {}}) : *known;
    pass.ms.push_back(time.ms);
  }
}

base::Json PassTable::figures() const {
  base::Json out = base::Json::object();
  for (const Pass& pass : passes_) out[pass.name] = base::quantile(pass.ms, 0.5);
  return out;
}

void print_passes(const base::Json& figures) {
  std::vector<std::pair<std::string, double>> passes;
  double sum = 0;
  for (const auto& [pass, ms] : figures.items()) {
    passes.emplace_back(pass, ms.get<double>());
    sum += passes.back().second;
  }
  std::sort(passes.begin(), passes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [pass, ms] : passes) std::printf("    %-12s %7.3f ms\n", pass.c_str(), ms);
  std::printf("    %-12s %7.3f ms\n", "all passes", sum);
}

}  // namespace measure
