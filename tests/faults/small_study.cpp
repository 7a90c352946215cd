#include "tests/faults/small_study.hpp"

#include <map>
#include <set>

#include "libstudy/session/interruptions.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/faults/file_calls.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace faults {

using namespace study;
namespace fixture = study::test;

namespace {

const Protocol& small_protocol() {
  static const Protocol protocol = parse_protocol(
      fixture::with_keys(
          fixture::without(fixture::protocol_text("ratings"), {"age", "warm_up", "smoothness"}),
          {{"mean_fps", "[10, 20]"}, {"duration_s", "0.3"}}),
      "small.toml");
  return protocol;
}

/// A gaze and a head pose that do not move.
class Still final : public GazeSource, public SlotSource {
 public:
  Still(double place, const Clock& clock) : place_(place), clock_(clock) {}
  GazeOrigin origin() const override { return GazeOrigin::Mouse; }
  void start() override {}
  std::vector<GazeSample> take() override { return {{clock_.now_ns(), {}, true, GazePoint{place_, place_}}}; }
  void stop() override {}
  HeadsetFacts facts() const override {
    const EyeFacts eye{100, 100, -40, 40, 40, -40};
    HeadsetFacts facts{"none", "1", "none", {eye, eye}, "rgb", {}, {}, "image", "opaque"};
    return facts;
  }
  void start_slots(bool with_heads) override { heads_ = with_heads; }
  std::vector<SlotRecord> take_slots() override {
    SlotRecord slot{clock_.now_ns(), 11, true, {}, 0};
    if (heads_) slot.head = HeadPose{{place_, 0, 0}, {0, 0, 0, 1}, true, true, true, true};
    return {slot};
  }
  void stop_slots() override {}
  std::optional<double> ipd_mm() override { return {}; }
  std::vector<std::string> take_news() override { return {}; }

 private:
  double place_;
  const Clock& clock_;
  bool heads_ = false;
};

std::uint64_t number_of(const Person& person) {
  return std::stoull(base::sha256_hex(person.key()).substr(0, 12), nullptr, 16);
}

void play_session(Store& store, PersonalFile& personal, const Protocol& protocol, const OpenSession& session,
                  const Person& person, int& units) {
  fixture::Scripted says;
  says.says["gaze_kept"] = fixture::score(person.gaze ? 1 : 0);
  says.says["data_shared"] = fixture::score(person.sharing ? 1 : 0);
  says.says["town"] = fixture::words("town " + person.mark());
  says.says["remarks"] = fixture::words("words " + person.mark());
  fixture::Desk desk(protocol);
  Still still(person.place(), desk.clock);
  SessionParts parts = desk.parts(says, store);
  parts.personal = &personal;
  parts.gaze = &still;
  parts.slots = &still;
  SessionHooks hooks;
  hooks.begins = [&](const OpenUnit& unit) {
    if (!unit.trial || unit.trial->position != 0 || !store.allows_gaze(session.id)) return;
    const ValidatedPoint point{1, 0, 0, 9, 9, person.place(), {}, {}};
    store.add_validation(session.id, {&point, 1}, true);
  };
  hooks.done = [&](const UnitDone& done) {
    record_words("done " + person.key() + " " + std::to_string(done.unit.position));
    --units;
  };
  hooks.request = [&] { return units > 0 ? Request::GoOn : Request::Stop; };
  run_session(protocol, session, parts, hooks);
}

/// People whom the database knows, in any state.
std::set<std::string> known(const fs::path& database) {
  std::set<std::string> all;
  std::error_code none;
  if (!fs::exists(database, none) || fs::file_size(database, none) == 0) return all;
  sqlite::Connection file(database, sqlite::Open::Read);
  if (file.integer("SELECT count(*) FROM sqlite_schema WHERE name = 'tombstone'") == 0) return all;
  sqlite::Statement row(file,
                        "SELECT code || '@' || station FROM session UNION "
                        "SELECT code || '@' || station FROM tombstone");
  while (row.step()) all.insert(row.text(0));
  return all;
}

void play_open(const fs::path& database, Store& store, const Protocol& protocol,
               const std::vector<Person>& people, int units) {
  for (const OpenRun& run : store.open_runs())
    for (const OpenSession& session : run.sessions) settle_interruption(store, protocol, session);
  PersonalFile personal(database);
  try {
    for (const OpenRun& run : store.open_runs()) {
      for (const OpenSession& session : run.sessions) {
        for (const Person& person : people) {
          // A merge may change the code, but not the station.
          if (person.station == session.plan.station && session.plan.participant.starts_with(person.code))
            play_session(store, personal, protocol, session, person, units);
        }
      }
    }
  } catch (const Stopped&) {
  }
}

}  // namespace

std::string Person::mark() const { return "zq" + base::sha256_hex(key() + " mark").substr(0, 14); }

double Person::place() const { return 0.1 + static_cast<double>(number_of(*this) % 800'000'000'007) / 1e12; }

void check_cleaned(const fs::path& database, std::vector<std::string> left, bool export_was_cut) {
  const auto says = [](const std::string& line, const char* words) {
    return line.find(words) != std::string::npos;
  };
  std::erase_if(left, [&](const std::string& line) {
    if (line.starts_with("backup ")) return says(line, ": holds gaze that ");
    return line.starts_with("export ") &&
           (says(line, ": may hold gaze that ") || (export_was_cut && says(line, " is no longer there")));
  });
  if (left.empty()) return;
  std::string lines;
  for (const std::string& line : left) lines += line + "; ";
  throw base::Error(database.string(), "is not clean: " + lines, "let the command that ran clean them up");
}

void play(const fs::path& database, const std::vector<Person>& people, int units) {
  const Protocol& protocol = small_protocol();
  const auto there = known(database);
  Store store(database, sqlite::Open::Create);
  RunPlan run{protocol, "{}", {}};
  for (const Person& person : people) {
    if (there.contains(person.key())) continue;
    run.sessions.push_back(fixture::session_plan(protocol, person.code, number_of(person)));
    run.sessions.back().station = person.station;
  }
  if (!run.sessions.empty()) store.add_run(run);
  play_open(database, store, protocol, people, units);
  check_cleaned(database, store.left_to_clean());
}

void resume(const fs::path& database, const std::vector<Person>& people) {
  const Protocol& protocol = small_protocol();
  Store store(database, sqlite::Open::Write);
  play_open(database, store, protocol, people, 1000);
  check_cleaned(database, store.left_to_clean());
}

}  // namespace faults
