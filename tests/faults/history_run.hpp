#pragma once
/// The execution of one history.

#include <string>
#include <vector>

#include "tests/faults/crash_states.hpp"
#include "tests/faults/history.hpp"
#include "tests/faults/history_stations.hpp"

namespace faults {

/// Runs a history step by step.
class HistoryRun {
 public:
  explicit HistoryRun(const fs::path& folder) : stations_(folder) {}

  Problems take(const Step& step, std::string& told);
  bool is_over() const { return over_; }

 private:
  using Work = std::function<void()>;

  /// Runs `work` with the step's fault. If the fault stops it, opens the station again, and repeats the
  /// command if `always` or the step says so. Returns true if the command is done.
  bool command(const Step& step, bool always, const Work& work);
  void session(const Step& step);
  void consent(const Step& step);
  void withdraw(const Step& step);
  void merge(const Step& step);
  void merge_again(const Step& step, const Tree& before, std::vector<fs::path> sources);
  void write_export(const Step& step);
  void back_up();
  void restore(const Step& step);
  void salvage(const Step& step);

  void learn();
  std::string free_code(const std::string& start);
  void wrong(const std::string& problem) { problems_.push_back(problem); }
  Station& here() { return stations_[station_]; }
  fs::path database() const { return stations_.database_of(station_); }
  /// Person::key() of a person whom the station knows; empty if none.
  std::string somebody(const Step& step);
  DatabaseFacts facts() { return stations_.facts_of(station_, problems_); }

  Stations stations_;
  std::size_t station_ = 0;
  Problems problems_;
  std::string told_;
  bool over_ = false;
  bool export_was_cut_ = false;  // true after a fault cut an export, at any station
};

}  // namespace faults
