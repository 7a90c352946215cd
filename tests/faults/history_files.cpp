/// Commands of a history that work on whole databases.
#include <algorithm>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "tests/faults/history_run.hpp"

namespace faults {

using How = Ended::How;

void HistoryRun::merge(const Step& step) {
  std::vector<std::size_t> from;
  std::vector<fs::path> sources;
  bool restored = false;
  told_ += "merge of";
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const bool empty = stations_[i].people.empty() && stations_[i].withdrawn.empty();
    if (i == station_ || !(step.choice >> i & 1) || empty) continue;
    from.push_back(i);
    sources.push_back(stations_.database_of(i));
    restored = restored || stations_[i].restored;
    told_ += " " + stations_[i].name + (stations_[i].restored ? " (an older copy was put back)" : "");
  }
  told_ += " into it";
  if (from.empty() || here().restored) return;
  const Tree before = step.other ? read_tree(stations_.root()) : Tree();
  const auto work = [&] {
    const auto done = study::merge(sources, database());
    check_cleaned(database(), done.beside.left, export_was_cut_);
  };
  if (restored) {
    // A merge into a restored database must be refused, or bring back nobody who withdrew; other content
    // cannot be predicted.
    const Ended ended = stations_.perform(step, station_, false, work);
    std::set<std::string> gone = here().withdrawn;
    for (const std::size_t i : from)
      gone.insert(stations_[i].withdrawn.begin(), stations_[i].withdrawn.end());
    for (const auto& [key, one] : facts().sessions)
      if (gone.contains(key)) wrong("tombstone: " + key + " came back by the merge");
    over_ = ended.how == How::Done;
    told_ += over_ ? "" : " -> refused";
    return;
  }
  if (!command(step, true, work)) return;
  for (const std::size_t i : from) {
    const Station& other = stations_[i];
    here().known.insert(other.known.begin(), other.known.end());
    here().people.insert(other.people.begin(), other.people.end());
    here().withdrawn.insert(other.withdrawn.begin(), other.withdrawn.end());
  }
  for (const std::string& key : here().withdrawn) here().people.erase(key);
  if (step.other && step.fault == Step::Fault::None) merge_again(step, before, sources);
}

void HistoryRun::merge_again(const Step& step, const Tree& before, std::vector<fs::path> sources) {
  const auto wanted = describe(facts());
  const auto once_more = [&](const char* how) {
    const Ended ended = stations_.perform(step, station_, false, [&] { study::merge(sources, database()); });
    if (ended.how != How::Done) wrong(std::string("merged ") + how + ": " + ended.problem);
    const auto found = describe(facts());
    for (const std::string& line : wanted)
      if (std::find(found.begin(), found.end(), line) == found.end())
        wrong(std::string("merged ") + how + " it lacks '" + line + "'");
    if (found.size() != wanted.size()) wrong(std::string("merged ") + how + " it has other people");
  };
  once_more("twice");
  std::reverse(sources.begin(), sources.end());
  write_tree(before, stations_.root());
  once_more("in another order");
}

void HistoryRun::back_up() {
  if (!stations_.has_database(station_) || here().restored) return;
  const fs::path copy = stations_.kept(stations_.copies.size());
  fs::copy_file(database(), copy);
  told_ += "a copy of the database is kept";
  stations_.copies.push_back({station_, copy, here().exports});
}

/// Restores only a copy that knows all exports, because others could never be found again.
void HistoryRun::restore(const Step& step) {
  std::vector<KeptCopy> fit;
  for (const KeptCopy& copy : stations_.copies)
    if (copy.station == station_ && copy.exports == here().exports) fit.push_back(copy);
  if (fit.empty()) return;
  for (const char* part : {"-wal", "-shm"}) fs::remove(database().string() + part);
  const KeptCopy& copy = fit[step.who % fit.size()];
  fs::copy_file(copy.file, database(), fs::copy_options::overwrite_existing);
  told_ += "copy " + copy.file.filename().string() + " is put back";
  here().restored = true;
}

/// Salvages the database as the error messages of commands that write advise, and puts the result in its
/// place.
void HistoryRun::salvage(const Step& step) {
  if (!stations_.has_database(station_)) return;
  told_ += "salvage";
  const fs::path made = stations_.folder_of(station_) / "new.db";
  const bool lossy = here().restored;
  const auto work = [&] {
    if (!fs::exists(made)) study::salvage(database(), made);
  };
  Ended ended = stations_.perform(step, station_, true, work);
  if (ended.how != How::Done && step.fault != Step::Fault::None) {
    told_ += ended.how == How::Killed ? " -> killed, given again" : " -> failed, given again";
    ended = stations_.perform(step, station_, false, work);
  }
  if (here().people.empty() && here().withdrawn.empty()) return;  // there may be nothing to salvage
  if (ended.how != How::Done) return wrong("salvage: " + ended.problem);
  for (const char* part : {"-wal", "-shm", ".answers.jsonl", ""}) fs::remove(database().string() + part);
  for (const char* part : {"-wal", ".answers.jsonl", ""})
    if (fs::exists(made.string() + part)) fs::rename(made.string() + part, database().string() + part);
  for (const auto& entry : fs::directory_iterator(stations_.folder_of(station_)))
    if (entry.path().filename().string().starts_with("new.db")) fs::remove_all(entry.path());
  stations_.lost_gaze = stations_.lost_gaze || lossy;
  here().restored = false;
  const auto own = stations_.own_people(station_);
  ended = stations_.perform(step, station_, false, [&] { resume(database(), own); });
  if (ended.how != How::Done) wrong("after salvage: " + ended.problem);
}

}  // namespace faults
