#include <algorithm>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"

namespace study {

const char* hold_name(Hold hold) {
  constexpr const char* names[] = {"image", "state", "head_locked"};
  return names[static_cast<int>(hold)];
}

HeadsetRules read_headset(const base::TomlTable& table) {
  HeadsetRules rules;
  const std::string hold = table.choice_or("hold", "image", {"image", "state", "head_locked"});
  rules.hold = hold == "state" ? Hold::State : hold == "head_locked" ? Hold::HeadLocked : Hold::Image;
  const auto acknowledged =
      table.has("acknowledge") ? distinct_words(table, "acknowledge") : std::vector<std::string>();
  for (std::size_t i = 0; i < acknowledged.size(); ++i) {
    if (acknowledged[i] == "head_locked") continue;
    table.fail_at("acknowledge", i, "= " + base::toml_quoted(acknowledged[i]) + " cannot be acknowledged",
                  base::use_one_of(acknowledged[i], {"head_locked"}));
  }
  const bool knows = std::find(acknowledged.begin(), acknowledged.end(), "head_locked") != acknowledged.end();
  if (rules.hold == Hold::HeadLocked && !knows) {
    table.fail("hold", "= \"head_locked\" moves the world with the head, which makes people sick",
               "use image or state, or add acknowledge = [\"head_locked\"]");
  }
  rules.hold_margin_deg = table.number_or("hold_margin_deg", 0, {0, 30});
  if (rules.hold != Hold::Image && rules.hold_margin_deg > 0)
    table.fail("hold_margin_deg", "is for hold = \"image\"", "remove it");
  rules.world_scale = table.number_or("world_scale", 1, {0.01, 100});
  if (table.has("refresh_hz")) rules.refresh_hz = table.number("refresh_hz", {10, 1000});
  return rules;
}

}  // namespace study
