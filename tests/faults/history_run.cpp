#include "tests/faults/history_run.hpp"

#include <iterator>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/withdraw.hpp"

namespace faults {

using Kind = Step::Kind;
using How = Ended::How;

namespace {

constexpr std::int64_t recovery_s = 60;

}  // namespace

std::string HistoryRun::somebody(const Step& step) {
  const auto& people = here().people;
  if (people.empty()) return {};
  return *std::next(people.begin(), static_cast<long>(step.who % people.size()));
}

bool HistoryRun::command(const Step& step, bool always, const Work& work) {
  const auto before = bytes_of_folder(stations_.folder_of(station_));
  const auto refused = [&](const Ended& ended) {
    told_ += " -> refused";
    if (!here().restored) return wrong("refused without a fault: " + ended.problem);
    for (const std::string& problem : check_unchanged(before, stations_.folder_of(station_))) wrong(problem);
  };
  Ended ended = stations_.perform(step, station_, true, work);
  if (ended.how == How::Broken) wrong("broken: " + ended.problem);
  if (ended.how == How::Done) {
    here().restored = false;
    return true;
  }
  if (step.fault == Step::Fault::None || (ended.how == How::Refused && here().restored)) {
    refused(ended);
    return false;
  }
  told_ += ended.how == How::Killed ? " -> killed" : " -> failed";
  here().ahead_s += recovery_s;
  if (stations_.has_database(station_)) {
    const auto own = stations_.own_people(station_);
    const auto open = [&] {
      return stations_.perform(step, station_, false, [&] { resume(database(), own); });
    };
    ended = open();
    if (ended.how != How::Done && !here().restored) wrong("cannot be opened after a fault: " + ended.problem);
    if (here().restored && ended.how != How::Done) return false;
    here().restored = false;  // opening made it equal to the journal
  }
  if (!always && !step.other) return false;
  here().ahead_s += recovery_s;
  ended = stations_.perform(step, station_, false, work);
  told_ += ", given again";
  // The error says that the session's plan is already stored: open() above resumed and finished that session.
  if (ended.problem.find("continue with vip-study resume") != std::string::npos) return true;
  if (ended.how != How::Done) wrong("given again: " + ended.problem);
  return ended.how == How::Done;
}

/// Adds answers on consent pages that the model does not know yet.
void HistoryRun::learn() {
  for (const auto& [key, one] : facts().sessions) {
    if (one.station != here().name || here().people.contains(key) || here().withdrawn.contains(key)) continue;
    here().people.insert(key);
    const Person& person = stations_.persons.at(key);
    stations_.decisions.decide(here().known, key, What::Gaze, person.gaze);
    stations_.decisions.decide(here().known, key, What::Sharing, person.sharing);
  }
}

/// A participant code that was never used at this station.
std::string HistoryRun::free_code(const std::string& start) {
  std::set<std::string> taken;
  for (const auto& [key, one] : facts().sessions) taken.insert(one.participant);
  for (const Person& person : stations_.own_people(station_)) taken.insert(person.code);
  for (const std::string& key : here().withdrawn) taken.insert(stations_.persons.at(key).code);
  for (int number = 1;; ++number)
    if (const std::string code = start + std::to_string(number); !taken.contains(code)) return code;
}

void HistoryRun::session(const Step& step) {
  if (!here().records) return;
  // Several stations use some of the same codes.
  const std::string start = step.choice % 3 == 0 ? "P" : here().name.substr(0, 1) + "Q";
  const Person person{free_code(start), here().name, step.yes, step.seed % 4 != 0};
  stations_.persons[person.key()] = person;
  told_ += "session of " + person.key() + ", gaze " + (person.gaze ? "yes" : "no") + ", sharing " +
           (person.sharing ? "yes" : "no");
  const auto own = stations_.own_people(station_);
  const bool was_restored = here().restored;
  const bool done = command(step, false, [&] { play(database(), {person}); });
  if (was_restored && here().restored) return;
  learn();
  if (done && !here().people.contains(person.key())) wrong("lost: the session of " + person.key());
}

void HistoryRun::consent(const Step& step) {
  const std::string key = somebody(step);
  if (key.empty() || here().restored) return;
  const What what = step.choice % 3 == 0 ? What::Sharing : What::Gaze;
  const char* name = what == What::Gaze ? "gaze" : "sharing";
  told_ += std::string("consent of ") + key + ": " + name + (step.yes ? " yes" : " no");
  const SessionFacts before = facts().sessions[key];
  study::PermissionRequest request;
  (what == What::Gaze ? request.gaze : request.sharing) = step.yes;
  const bool done = command(step, false, [&] {
    const auto change = study::change_permissions(database(), before.participant, request);
    check_cleaned(database(), change.left, export_was_cut_);
  });
  const SessionFacts after = facts().sessions[key];
  const bool recorded = what == What::Gaze ? after.gaze_changes > before.gaze_changes
                                           : after.sharing_changes > before.sharing_changes;
  if (done && !recorded) wrong("acknowledged: the decision of " + key + " is not recorded");
  if (recorded) stations_.decisions.decide(here().known, key, what, step.yes);
}

void HistoryRun::withdraw(const Step& step) {
  const std::string key = somebody(step);
  if (key.empty() || here().restored) return;
  told_ += "withdrawal of " + key;
  const std::string code = facts().sessions[key].participant;
  const bool done = command(step, false, [&] {
    check_cleaned(database(), study::withdraw(database(), code).beside.left, export_was_cut_);
  });
  if (!done && !facts().withdrawn.contains(key)) return;
  here().people.erase(key);
  here().withdrawn.insert(key);
}

void HistoryRun::write_export(const Step& step) {
  if (!stations_.has_database(station_) || here().restored) return;
  const std::string name = "out" + std::to_string(step.choice % 4);
  const fs::path out = stations_.folder_of(station_) / name;
  told_ += "export to " + name;
  export_was_cut_ = export_was_cut_ || step.fault != Step::Fault::None;
  command(step, false, [&] {
    if (step.choice % 4 == 0) study::export_csv(database(), out, {true, step.yes});
    if (step.choice % 4 == 1) study::export_psych_ds(database(), out);
    if (step.choice % 4 >= 2) study::export_bids(database(), out, step.yes);
  });
  if (fs::exists(out)) here().exports.insert(name);
}

Problems HistoryRun::take(const Step& step, std::string& told) {
  station_ = step.station % stations_.size();
  for (std::size_t i = 0; i < stations_.size(); ++i) stations_[i].ahead_s += step.wait_s;
  here().ahead_s += step.jump_s;
  problems_.clear();
  told_ = "at " + here().name + " (clock " + std::to_string(here().ahead_s) + " s): ";
  switch (step.kind) {
    case Kind::Session:
      session(step);
      break;
    case Kind::Consent:
      consent(step);
      break;
    case Kind::Withdraw:
      withdraw(step);
      break;
    case Kind::Merge:
      merge(step);
      break;
    case Kind::Export:
      write_export(step);
      break;
    case Kind::BackUp:
      back_up();
      break;
    case Kind::Restore:
      restore(step);
      break;
    case Kind::Salvage:
      salvage(step);
      break;
    case Kind::Resume:
      told_ += "resume";
      if (stations_.has_database(station_))
        command(step, false, [&] { resume(database(), stations_.own_people(station_)); });
      break;
    case Kind::Status:
      told_ += "status";
      if (stations_.has_database(station_))
        stations_.perform(step, station_, true, [&] { study::read_status(database()); });
      break;
  }
  if (!over_)
    for (const std::string& problem : stations_.check(station_, step.seed % 3 == 0 || here().restored))
      wrong(problem);
  told = told_;
  return problems_;
}

Problems run_history(const std::vector<Step>& steps, const fs::path& folder, std::vector<std::string>& told) {
  HistoryRun run(folder);
  for (const Step& step : steps) {
    told.emplace_back();
    const Problems problems = run.take(step, told.back());
    if (!problems.empty() || run.is_over()) return problems;
  }
  return {};
}

}  // namespace faults
