#pragma once
/// A model of people's decisions as each station knows them: the result of a study without faults and with
/// one clock.
///
/// A decision is made at one station, after all decisions known to it. Merged stations know all that each of
/// them knew. A refusal holds until a consent that was recorded after it, at a station that knew of it.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/faults/small_study.hpp"

namespace faults {

enum class What { Gaze, Sharing };

class Decisions {
 public:
  using Known = std::set<std::size_t>;

  /// Adds a decision made after those in `known`, and adds it to `known`.
  void decide(Known& known, const std::string& person, What what, bool yes) {
    all_.push_back({person, what, yes, known});
    known.insert(all_.size() - 1);
  }
  /// True if allowed; refused if nothing is known.
  bool allows(const Known& known, const std::string& person, What what) const {
    bool any = false;
    for (const std::size_t one : known) {
      if (!concerns(one, person, what)) continue;
      any = true;
      if (!all_[one].yes && !is_overruled(known, one)) return false;
    }
    return any;
  }
  /// True if it was ever refused, at any station.
  bool was_refused(const std::string& person, What what) const {
    for (std::size_t one = 0; one < all_.size(); ++one)
      if (concerns(one, person, what) && !all_[one].yes) return true;
    return false;
  }

 private:
  struct Decision {
    std::string person;
    What what;
    bool yes;
    Known before;
  };
  bool concerns(std::size_t one, const std::string& person, What what) const {
    return all_[one].person == person && all_[one].what == what;
  }
  bool is_overruled(const Known& known, std::size_t refusal) const {
    for (const std::size_t one : known)
      if (concerns(one, all_[refusal].person, all_[refusal].what) && all_[one].yes &&
          all_[one].before.contains(refusal))
        return true;
    return false;
  }

  std::vector<Decision> all_;
};

}  // namespace faults
