#include "libstudy/store/merge/balance.hpp"

#include <algorithm>
#include <map>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* protocols_sql =
    "SELECT p.protocol_id, p.name, p.version, p.text, p.trial_seconds FROM protocol p WHERE EXISTS "
    "(SELECT 1 FROM session s WHERE s.protocol_id = p.protocol_id AND s.test_data = p.test_data AND "
    "s.state IN ('open', 'done', 'stopped')) ORDER BY p.protocol_id";

std::vector<int> slots_of(sqlite::Connection& database, std::int64_t protocol_id) {
  Statement row(database,
                "SELECT s.slot FROM session s JOIN protocol p USING (protocol_id) WHERE protocol_id = ? AND "
                "s.test_data = p.test_data AND s.state IN ('open', 'done', 'stopped')");
  std::vector<int> slots;
  for (row.bind_all(protocol_id); row.step();) slots.push_back(static_cast<int>(row.integer(0)));
  return slots;
}

void count_uses(const Protocol& protocol, const std::vector<int>& slots, Balance& balance) {
  balance.slot_uses.assign(static_cast<std::size_t>(slot_count(protocol)), 0);
  for (const int slot : slots) ++balance.slot_uses[static_cast<std::size_t>(slot) % balance.slot_uses.size()];
  if (protocol.design.assignment == Assignment::PaperRandom) {
    balance.sequence_uses = {balance.sessions};
    return;
  }
  std::map<std::vector<int>, int> uses;
  for (int slot = 0; slot < slot_count(protocol); ++slot)
    uses[groups_met(protocol, slot, 0)] += balance.slot_uses[static_cast<std::size_t>(slot)];
  for (const auto& [groups, count] : uses) balance.sequence_uses.push_back(count);
}

bool uneven(const std::vector<int>& uses) {
  if (uses.empty()) return false;
  const auto [least, most] = std::minmax_element(uses.begin(), uses.end());
  return *most - *least > 1;
}

std::string times(int count) {
  return count == 0 ? "never" : count == 1 ? "once" : count == 2 ? "twice" : std::to_string(count) + " times";
}

/// "each used once", or "6 used twice, 6 never".
std::string uses_words(const std::vector<int>& uses) {
  std::map<int, int, std::greater<>> by_count;
  for (const int count : uses) ++by_count[count];
  if (by_count.size() == 1) return "each used " + times(uses.front());
  std::string out;
  for (const auto& [count, how_many] : by_count)
    out += (out.empty() ? std::to_string(how_many) + " used " : ", " + std::to_string(how_many) + " ") +
           times(count);
  return out;
}

}  // namespace

bool Balance::off() const { return uneven(sequence_uses) || uneven(slot_uses); }

std::vector<Balance> read_balance(sqlite::Connection& database) {
  std::vector<Balance> out;
  for (Statement row(database, protocols_sql); row.step();) {
    const auto slots = slots_of(database, row.integer(0));
    Balance balance{row.text(1), row.text(2), static_cast<int>(slots.size()), {}, {}};
    try {
      Protocol protocol = parse_protocol(row.text(3), "protocol " + balance.name, ProtocolUse::Stored);
      if (!row.is_null(4)) override_trial_seconds(protocol, row.real(4));
      count_uses(protocol, slots, balance);
    } catch (const base::Error&) {
      // Written by an earlier version: describe() says so.
    }
    out.push_back(std::move(balance));
  }
  return out;
}

std::string describe(const Balance& balance) {
  std::string out = balance.name + " " + balance.version + ", " + std::to_string(balance.sessions) +
                    (balance.sessions == 1 ? " session: " : " sessions: ");
  if (balance.slot_uses.empty()) return out + "not known, as this version does not read the protocol";
  const std::size_t sequences = balance.sequence_uses.size(), slots = balance.slot_uses.size();
  if (slots == 1) return out + "nothing is balanced between participants";
  if (sequences > 1) out += std::to_string(sequences) + " sequences, " + uses_words(balance.sequence_uses);
  if (slots > sequences)
    out += (sequences > 1 ? "; " : "") + std::to_string(slots) + " slots, " + uses_words(balance.slot_uses);
  return out;
}

}  // namespace study
