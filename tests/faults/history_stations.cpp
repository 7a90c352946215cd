#include "tests/faults/history_stations.hpp"

#include <cstdlib>

#include "libstudy/store/file/database.hpp"
#include "tests/faults/crash_states.hpp"
#include "tests/faults/crashes.hpp"

namespace faults {

using Fault = Step::Fault;

namespace {

constexpr int last_unit = 4;  // position of a session's last unit (small_study.cpp)

CallPlan plan_of(const Step& step) {
  CallPlan plan;
  using Kind = CallPlan::Kind;
  const bool power = step.fault == Fault::PowerExt4 || step.fault == Fault::PowerPosix;
  plan.kind = step.fault == Fault::None                                  ? Kind::None
              : step.fault == Fault::Tear                                ? Kind::Tear
              : step.fault == Fault::Error                               ? Kind::Error
              : step.fault == Fault::Full || step.fault == Fault::FullOn ? Kind::Full
                                                                         : Kind::Kill;
  plan.from_then_on = step.fault == Fault::FullOn;
  plan.at = step.at;
  plan.record = power;
  return plan;
}

}  // namespace

Stations::Stations(const fs::path& folder)
    : root_(folder / "now"), kept_(folder / "kept"), peek_(folder / "peek") {
  fs::remove_all(folder);
  for (const char* name : {"north", "south", "west", "all"}) {
    all_.push_back({});
    all_.back().name = name;
    all_.back().records = name != std::string("all");
    fs::create_directories(root_ / name);
  }
  fs::create_directories(kept_);
  // The register of exports is a file like others: a power cut may undo its changes.
  ::setenv("VIP_STATE_DIR", (root_ / "state").c_str(), 1);
}

fs::path Stations::kept(std::size_t number) const { return kept_ / std::to_string(number); }

bool Stations::has_database(std::size_t station) const { return !study::holds_nothing(database_of(station)); }

Ended Stations::perform(const Step& step, std::size_t station, bool with_fault,
                        const std::function<void()>& command) {
  CallPlan plan = with_fault ? plan_of(step) : CallPlan();
  plan.folder = root_.string();
  plan.log = &log_;
  plan.clock_ahead_s = all_.at(station).ahead_s;
  const Tree before = plan.record ? read_tree(root_) : Tree();
  Ended ended = run_child(plan, command);
  if (plan.record && ended.how == Ended::How::Killed) {
    const Model model = step.fault == Fault::PowerExt4 ? Model::Ext4 : Model::Posix;
    const Kept kept = step.seed % 3 == 0 ? Kept::Least : Kept::Some;
    write_tree(crash_state(before, ended.calls, ended.calls.size(), model, kept, step.seed), root_);
  }
  take_acknowledged(ended.calls, ended.calls.size(), all_.at(station).acknowledged);
  return ended;
}

std::vector<Person> Stations::people_of(const std::set<std::string>& keys) const {
  std::vector<Person> people;
  for (const std::string& key : keys) people.push_back(persons.at(key));
  return people;
}

std::vector<Person> Stations::own_people(std::size_t station) const {
  std::vector<Person> people;
  for (const auto& [key, person] : persons)
    if (person.station == all_.at(station).name) people.push_back(person);
  return people;
}

DatabaseFacts Stations::facts_of(std::size_t station, Problems& problems) const {
  return read_facts(database_of(station), peek_, problems);
}

void Stations::check_decisions(const Station& station, const DatabaseFacts& facts, Problems& problems) const {
  for (const std::string& key : station.people) {
    const auto found = facts.sessions.find(key);
    if (found == facts.sessions.end()) {
      problems.push_back("lost: " + key + " is not in the database");
      continue;
    }
    const SessionFacts& one = found->second;
    const auto compare = [&](What what, const std::optional<bool>& now, const char* name) {
      if (now && *now != decisions.allows(station.known, key, what))
        problems.push_back(std::string(*now ? "refused: " : "allowed: ") + name + " of " + key + " is " +
                           (*now ? "allowed in the database, and was refused last"
                                 : "refused in the database, and was allowed last"));
    };
    compare(What::Gaze, one.gaze, "gaze");
    compare(What::Sharing, one.sharing, "sharing");
    if (!lost_gaze && !decisions.was_refused(key, What::Gaze) && one.done.contains(last_unit) &&
        one.gaze_rows == 0)
      problems.push_back("lost: gaze of " + key + ", who never refused it");
  }
  for (const auto& [key, one] : facts.sessions)
    if (!station.people.contains(key)) problems.push_back("tombstone: " + key + " is in the database again");
  if (facts.withdrawn != station.withdrawn) problems.push_back("tombstone: those in the database are others");
}

Problems Stations::check(std::size_t index, bool exports) {
  const Station& station = all_.at(index);
  Problems problems;
  if (!has_database(index)) {
    if (!station.people.empty()) problems.push_back("lost: the database");
    return problems;
  }
  DatabaseFacts facts = facts_of(index, problems);
  const auto add = [&](const Problems& more) { problems.insert(problems.end(), more.begin(), more.end()); };
  const auto gone = people_of(station.withdrawn);
  if (!station.restored) {
    check_decisions(station, facts, problems);
    add(check_refused(facts));
    add(check_acknowledged(facts, database_of(index), station.acknowledged, true));
    add(check_withdrawn(folder_of(index), gone));
  }
  if (exports) {
    for (auto& [key, one] : facts.sessions) {
      // The decisions known to the station count, even if a restored database does not know of a refusal.
      if (one.gaze && !decisions.allows(station.known, key, What::Gaze)) one.gaze = false;
      if (one.sharing && !decisions.allows(station.known, key, What::Sharing)) one.sharing = false;
    }
    add(check_exports(facts, folder_of(index), peek_, gone));
  }
  return problems;
}

}  // namespace faults
