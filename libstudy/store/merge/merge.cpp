#include "libstudy/store/merge/merge.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/merge/merge_parts.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/refusals.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;
using merging::Content;
using merging::SessionCopy;
using sqlite::Connection;
using sqlite::Open;
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

/// Numbers of uses in words: "each used once", or "6 used twice, 6 never".
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
      // This version of the program cannot read the protocol: slot_uses stays empty, and describe() reports
      // that.
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

namespace {

/// A person with sessions in the database `into` before the merge, with their participant code in it.
struct Resident {
  std::string person, participant;
  Stock stock;
};

std::vector<Resident> residents_of(Connection& database) {
  std::vector<Resident> residents;
  Statement row(database, "SELECT DISTINCT person, participant FROM session ORDER BY participant");
  while (row.step()) residents.push_back({row.text(0), row.text(1), {}});
  for (Resident& resident : residents) resident.stock = take_stock(database, resident.person);
  return residents;
}

/// The source files without duplicates and without `into`.
std::vector<fs::path> distinct(const std::vector<fs::path>& sources, const fs::path& into) {
  std::set<fs::path> known{fs::weakly_canonical(into)};
  std::vector<fs::path> out;
  for (const fs::path& source : sources) {
    if (known.insert(fs::weakly_canonical(source)).second) out.push_back(source);
  }
  return out;
}

Content read_all(const std::vector<fs::path>& sources, const fs::path& into, bool incomplete) {
  Content content;
  std::vector<fs::path> paths = distinct(sources, into);
  if (!holds_nothing(into)) paths.push_back(into);
  for (const fs::path& path : paths) {
    auto source = open_study({path, incomplete && path != into}).database;
    source->execute("BEGIN");  // reads a consistent state even while a session writes
    merging::add_source(content, std::move(source));
  }
  return content;
}

Merge sum_up(Connection& result, const Content& content, const std::vector<SessionCopy>& chosen,
             const std::map<std::string, std::string>& names) {
  Merge merge;
  merge.sessions = static_cast<std::int64_t>(chosen.size());
  const auto stand =
      std::count_if(content.copies.begin(), content.copies.end(),
                    [&](const SessionCopy& copy) { return !content.tombstones.contains(copy.person); });
  merge.recognised = stand - merge.sessions;
  std::set<std::string> renamed;
  for (const SessionCopy& copy : chosen) {
    if (copy.test_data) ++merge.test_sessions;
    const std::string& name = names.at(copy.person);
    if (name != copy.code)
      renamed.insert(copy.code + " of station '" + base::shortened(copy.station) + "' is " + name);
  }
  merge.renamed.assign(renamed.begin(), renamed.end());
  for (const auto& [person, stone] : content.tombstones) merge.withdrawn.push_back(names.at(person));
  std::sort(merge.withdrawn.begin(), merge.withdrawn.end());
  Statement row(result,
                "SELECT name || ' ' || version FROM protocol WHERE test_data = 0 GROUP BY name, version "
                "HAVING count(*) > 1 ORDER BY 1");
  while (row.step()) merge.namesakes.push_back(base::shortened(row.text(0)));
  merge.balance = read_balance(result);
  merge.station_troubles = merging::station_troubles(content);
  return merge;
}

/// Copies the clean-up chores that an earlier merge or withdrawal left undone. Must run before plan_chores(),
/// so that they are done first: they name participants by their codes from before this merge.
void carry_chores_over(Connection& into, Connection& result) {
  Statement row(into, "SELECT kind, batch, person, participant, renamed FROM chore ORDER BY chore_id");
  Statement insert(result,
                   "INSERT INTO chore (kind, batch, person, participant, renamed) VALUES (?,?,?,?,?)");
  while (row.step()) {
    for (int i = 0; i < row.columns(); ++i) insert.bind_from(i, row, i);
    insert.run();
  }
}

/// Copies the slots that a central database reserved for the station of `into`. Those of other stations stay
/// with their databases, so that no slot is dealt twice.
void carry_reserved_slots_over(Connection& into, Connection& result) {
  const std::string columns = listed(columns_of("reserved_slot"));
  Statement row(into, "SELECT " + columns + " FROM reserved_slot");
  Statement insert(result, "INSERT INTO reserved_slot (" + columns + ") VALUES (?,?,?,?,?,?,?,?,?)");
  while (row.step()) {
    for (int i = 0; i < row.columns(); ++i) insert.bind_from(i, row, i);
    insert.run();
  }
}

/// Plans chores in `result`, the merged database: to delete people who withdrew from the files beside it, to
/// change codes there as in `names`, and to rewrite the database file. Adds those people to merge.buried.
void plan_chores(Connection& result, const std::vector<Resident>& residents,
                 const std::map<std::string, std::string>& names, const Content& content, Merge& merge) {
  sqlite::Transaction transaction(result);
  ChorePlan plan(result);
  std::map<std::string, ChorePlan::Rename> renamed;
  for (const Resident& resident : residents) {
    if (content.tombstones.contains(resident.person)) {
      plan.forget(resident.person, resident.participant);
      merge.buried.emplace_back(resident.participant, resident.stock);
    } else if (const auto& name = names.at(resident.person); name != resident.participant) {
      renamed[resident.person] = {resident.participant, name};
    }
  }
  plan.rename(renamed);
  plan.rewrite();
  transaction.commit();
}

/// Adds to beside.left the backups and exports of `into` that may still contain gaze which this merge
/// deleted. `before`: the gaze data of `into` before the merge.
void name_refused(Connection& into, const GazeRows& before, CleanUp& beside) {
  for (std::string& line : name_gaze_elsewhere(into, people_with_less_gaze(into, before)))
    beside.left.push_back(std::move(line));
}

}  // namespace

Merge merge(const std::vector<fs::path>& sources, const fs::path& given, bool incomplete) {
  const fs::path into = real_file(given);
  WriterLock lock(into, Open::Create);
  Content content = read_all(sources, into, incomplete);
  const auto chosen = merging::choose_sessions(content);
  const auto names = merging::name_people(content);
  const auto result = make_temporary_database(into);
  merging::write_union(content, chosen, names, *result);
  Merge merge = sum_up(*result, content, chosen, names);
  content.sources.clear();  // closes the sources, as `into` may be one of them

  const auto target = open_database(into, Open::Create, read_schema_steps());
  carry_chores_over(*target, *result);
  carry_reserved_slots_over(*target, *result);
  plan_chores(*result, residents_of(*target), names, content, merge);
  std::vector<std::string> withdrawn;
  for (const auto& [person, stone] : content.tombstones) withdrawn.push_back(person);
  prepare_rewrite(*target, withdrawn);
  const GazeRows gaze_before = gaze_rows(*target);
  target->execute("PRAGMA secure_delete = ON");
  // Other programs can register exports in `into` despite the WriterLock. So copy_from() adds the registered
  // exports after it has locked the database.
  target->copy_from(*result, [&] {
    Connection standing(into, Open::Read);
    sqlite::Transaction transaction(*result);
    merging::add_exports(standing, *result);
    transaction.commit();
  });
  lock.keep();
  merge.beside = clean_up_all(*target);
  name_refused(*target, gaze_before, merge.beside);
  return merge;
}

}  // namespace study
