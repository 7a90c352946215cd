#pragma once
/// Names that BIDS and Psych-DS allow: letters and digits alone. Those of people and protocols are given once
/// and stored in the table `label`, so that no later participant takes over what was published.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// Gives each text a label of letters and digits, distinct from those of other texts.
class Labels {
 public:
  const std::string& of(const std::string& text);

 private:
  std::map<std::string, std::string> labels_;
  std::set<std::string> taken_;
};

/// A row of `label`.
struct GivenLabel {
  std::string kind, owner, label;
};

/// The labels of a database: those that are given, then what others without one get, in the order of codes.
std::vector<GivenLabel> labels_of(sqlite::Connection& database);
/// Stores what labels_of() adds, in a transaction of the caller.
void give_labels(sqlite::Connection& database);
/// The labels of several databases together. All of the first stay as they are; of the others each in turn
/// that is not given yet, with "x2" and so on behind it where it is taken.
std::vector<GivenLabel> joined_labels(const std::vector<GivenLabel>& first,
                                      const std::vector<GivenLabel>& others);
void store_labels(sqlite::Connection& database, const std::vector<GivenLabel>& labels);

/// A session as exports name it.
struct LabelledSession {
  std::int64_t id = 0;
  std::string person;                      ///< as in session
  std::string participant;                 ///< code
  std::string subject, session, protocol;  ///< labels; session: protocol and visit
};

/// The sessions that may stand in a public export, by participant, then in the order of planning. Whoever
/// refused that in one session, or was asked and has not answered, is left out with all of them. base::Error
/// where one has no label (give_labels).
std::vector<LabelledSession> shared_sessions(sqlite::Connection& database);
/// Whose they are: session.person.
std::set<std::string> people_of(const std::vector<LabelledSession>& sessions);

}  // namespace study
