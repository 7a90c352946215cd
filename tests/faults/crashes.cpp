#include "tests/faults/crashes.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace faults {

std::string CrashTry::text() const {
  static constexpr const char* names[] = {"least", "most", "some"};
  return std::string(name_of(model)) + ", " + names[static_cast<int>(kept)] +
         (kept == Kept::Some ? " by seed " + std::to_string(seed) : "") + ", after call " +
         std::to_string(count);
}

void take_acknowledged(const std::vector<Call>& calls, std::size_t count,
                       std::set<std::pair<std::string, int>>& all) {
  for (std::size_t i = 0; i < count; ++i) {
    if (calls[i].kind != Call::Kind::Words) continue;
    std::istringstream words(calls[i].bytes);
    std::string done, key;
    int position = 0;
    if (words >> done >> key >> position && done == "done") all.emplace(key, position);
  }
}

Crashes::Crashes(const Command& command, const fs::path& folder)
    : command_(command), now_(folder / "now"), peek_(folder / "peek") {
  fs::create_directories(now_);
  // The register of exports is a file like others: a power cut may undo its changes.
  ::setenv("VIP_STATE_DIR", (now_ / "state").c_str(), 1);
  const Ended prepared = run(command.prepare);
  if (prepared.how != Ended::How::Done)
    throw std::runtime_error(command.name + " cannot be prepared: " + prepared.problem);
  take_acknowledged(prepared.calls, prepared.calls.size(), acknowledged_before_);
  before_ = read_tree(now_);
  const auto bytes = bytes_of_folder(now_);
  CallPlan plan;
  plan.folder = now_.string();
  plan.log = &log_;
  plan.record = true;
  recorded_ = run_child(plan, [&] { command_.act(now_); });
  Problems& problems = at_first_;
  if (recorded_.how != (command.refuses ? Ended::How::Refused : Ended::How::Done))
    problems.push_back("without a fault: " + recorded_.problem);
  if (command.refuses)
    for (const std::string& problem : check_unchanged(bytes, now_))
      problems.push_back("without a fault: " + problem);
  problems.resize(std::min<std::size_t>(problems.size(), 3));
  wanted_ = described(problems);
  acknowledged_ = acknowledged_before_;
  take_acknowledged(recorded_.calls, recorded_.calls.size(), acknowledged_);
  check({"without a fault"}, command_.gone, problems);
}

std::string Crashes::last_call(const CrashTry& one) const {
  static constexpr const char* names[] = {"create", "write",    "truncate", "sync",   "sync folder",
                                          "rename", "exchange", "link",     "unlink", "mkdir",
                                          "rmdir",  "words",    "end"};
  if (one.count == 0) return "nothing";
  const Call& call = recorded_.calls[one.count - 1];
  std::string name = names[static_cast<int>(call.kind)];
  if (!call.path.empty()) name += " " + fs::path(call.path).lexically_relative(now_).string();
  return name;
}

Ended Crashes::run(const std::function<void(const fs::path&)>& work) {
  CallPlan plan;
  plan.log = &log_;
  return run_child(plan, [&] { work(now_); });
}

bool Crashes::make(const CrashTry& one) {
  state_ = crash_state(before_, recorded_.calls, one.count, one.model, one.kept, one.seed);
  acknowledged_ = acknowledged_before_;
  take_acknowledged(recorded_.calls, one.count, acknowledged_);
  return seen_.insert(hash_of(state_)).second;
}

void Crashes::check(const When& when, const Gone& gone, Problems& problems) {
  for (const std::string& name : command_.stations) {
    Problems found;
    const fs::path station = now_ / name;
    DatabaseFacts facts = read_facts(station / "s.db", peek_, found);
    // Exports obey the journal too, which may already hold a permission that the database lacks, so until the
    // database is settled the answers of these people count as unknown.
    if (!when.settled)
      for (const std::string& key : command_.allowed)
        if (facts.sessions.contains(key)) facts.sessions[key].gaze = facts.sessions[key].sharing = {};
    std::vector<Person> people;
    if (const auto all = gone.find(name); all != gone.end()) people = all->second;
    const auto add = [&](const Problems& more) { found.insert(found.end(), more.begin(), more.end()); };
    std::set<std::pair<std::string, int>> here;
    for (const auto& one : acknowledged_)
      if (one.first.ends_with("@" + name)) here.insert(one);
    const bool restored = command_.refuses;  // the restored database lacks later changes
    if (!restored && (facts.there || !here.empty()))
      add(check_acknowledged(facts, station / "s.db", here, when.settled));
    if (facts.there) {
      if (!restored) add(check_refused(facts));
      if (when.exports) add(check_exports(facts, station, peek_, people));
      if (!restored) add(check_withdrawn(station, people));
    }
    for (const std::string& problem : found) problems.push_back(when.name + ", " + name + ": " + problem);
  }
}

std::vector<std::string> Crashes::described(Problems& problems) {
  std::vector<std::string> all;
  for (const std::string& name : command_.stations) {
    all.push_back(name);
    for (const std::string& line : describe(read_facts(now_ / name / "s.db", peek_, problems)))
      all.push_back(line);
  }
  return all;
}

void Crashes::try_again(Problems& problems) {
  write_tree(state_, now_);
  const auto bytes = bytes_of_folder(now_);
  const auto& again = command_.again ? command_.again : command_.act;
  const Ended ended = run(again);
  if (command_.refuses) {
    if (ended.how != Ended::How::Refused) problems.push_back("again: it is not refused");
    for (const std::string& problem : check_unchanged(bytes, now_)) problems.push_back("again: " + problem);
    return;
  }
  if (ended.how != Ended::How::Done) {
    problems.push_back("again: " + ended.problem);
    return;
  }
  const auto found = described(problems);
  for (const std::string& line : wanted_)
    if (std::find(found.begin(), found.end(), line) == found.end())
      problems.push_back("again: lacks '" + line + "'");
  check({"again"}, command_.gone, problems);
}

Problems Crashes::go_on() {
  Problems problems;
  write_tree(state_, now_);
  // Exports may be made at once, although a commit's cleanup beside the database is not finished.
  Gone none = command_.refuses ? command_.gone : Gone{};
  check({"at once", command_.is_read, false}, none, problems);
  write_tree(state_, now_);
  const Ended ended = run(command_.other);
  if (ended.how != (command_.refuses ? Ended::How::Refused : Ended::How::Done))
    problems.push_back("another command: " + (ended.problem.empty() ? "not refused" : ended.problem));
  Gone gone = command_.gone_by_other;
  if (command_.refuses) gone = command_.gone;
  for (const auto& [name, people] : command_.gone) {
    const auto facts = read_facts(now_ / name / "s.db", peek_, problems);
    for (const Person& person : people)
      if (facts.withdrawn.contains(person.key())) gone[name].push_back(person);
  }
  check({"after another command"}, gone, problems);
  try_again(problems);
  return problems;
}

}  // namespace faults
