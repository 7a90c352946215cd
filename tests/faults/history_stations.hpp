#pragma once
/// The stations of a history: their folders, their clocks, and the decisions known to each.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/faults/child.hpp"
#include "tests/faults/decisions.hpp"
#include "tests/faults/history.hpp"

namespace faults {

/// What the model expects of a station.
struct Station {
  std::string name;
  bool records = true;  ///< people take part here; otherwise it has only merged data
  std::int64_t ahead_s = 0;
  Decisions::Known known;
  std::set<std::string> people, withdrawn;             ///< Person::key()
  std::set<std::pair<std::string, int>> acknowledged;  ///< units answered here
  std::set<std::string> exports;                       ///< folders of the station's exports
  bool restored = false;  ///< an older database was restored: commands may refuse it until it is salvaged
};

/// A copy of a database file alone, stored elsewhere.
struct KeptCopy {
  std::size_t station = 0;
  fs::path file;
  std::set<std::string> exports;
};

class Stations {
 public:
  explicit Stations(const fs::path& folder);

  Station& operator[](std::size_t index) { return all_.at(index); }
  std::size_t size() const { return all_.size(); }
  const fs::path& root() const { return root_; }
  fs::path kept(std::size_t number) const;
  fs::path folder_of(std::size_t station) const { return root_ / all_.at(station).name; }
  fs::path database_of(std::size_t station) const { return folder_of(station) / "s.db"; }
  bool has_database(std::size_t station) const;

  Decisions decisions;
  std::map<std::string, Person> persons;  ///< by Person::key()
  std::vector<KeptCopy> copies;
  bool lost_gaze = false;  ///< a salvage used only a journal, which has no gaze

  /// Runs the command in its own process with the station's clock and the fault of `step`. Applies the power
  /// cut, if any, and notes the acknowledged units.
  Ended perform(const Step& step, std::size_t station, bool with_fault, const std::function<void()>& command);
  std::vector<Person> people_of(const std::set<std::string>& keys) const;
  /// The people who take part at this station.
  std::vector<Person> own_people(std::size_t station) const;
  DatabaseFacts facts_of(std::size_t station, Problems& problems) const;
  /// Checks that the files of a station agree with the model.
  Problems check(std::size_t station, bool exports);

 private:
  void check_decisions(const Station& station, const DatabaseFacts& facts, Problems& problems) const;

  fs::path root_, kept_, peek_;
  std::vector<Station> all_;
  CallLog log_;
};

}  // namespace faults
