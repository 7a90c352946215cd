#include "stats/base/key_reference.hpp"

#include <algorithm>

namespace base {

namespace {

std::string key_row(const KeyReference& key, bool units) {
  const std::string values = key.values.empty() ? "" : ", " + key.values;
  const std::string fallback = key.fallback.empty() ? "needed" : key.fallback;
  return "| `" + key.key + "` | " + key.type + values + " | " + (units ? key.unit + " | " : "") + fallback +
         " | " + key.meaning + " |\n";
}

}  // namespace

std::string reference_sections(const std::vector<TableReference>& tables,
                               const std::vector<KeyReference>& keys) {
  const bool units = std::any_of(keys.begin(), keys.end(), [](const auto& key) { return !key.unit.empty(); });
  const std::string head = units ? "| key | type | unit | default | meaning |\n|---|---|---|---|---|\n"
                                 : "| key | type | default | meaning |\n|---|---|---|---|\n";
  std::string out;
  for (const auto& table : tables) {
    out += "\n## " + table.heading + "\n\n" + table.text + "\n\n" + head;
    for (const auto& key : keys)
      if (key.table == table.table) out += key_row(key, units);
  }
  return out;
}

}  // namespace base
