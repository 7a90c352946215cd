/// Any bytes as a protocol file: parsed and planned, or refused with base::Error.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"

namespace {

void plan_slot(const study::Protocol& protocol, int slot) {
  const auto plan = study::make_plan(protocol, "P01", 7, slot);
  const auto trials = std::count_if(plan.units.begin(), plan.units.end(),
                                    [](const auto& unit) { return unit.trial.has_value(); });
  if (static_cast<std::size_t>(trials) != plan.trials.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto protocol = study::parse_protocol({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
    if (study::next_slot(protocol, {}) != 0) std::abort();
    plan_slot(protocol, 0);
    plan_slot(protocol, study::slot_count(protocol) - 1);
  } catch (const base::Error&) {
  }
  return 0;
}
