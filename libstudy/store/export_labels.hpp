#pragma once
/// Labels for BIDS and Psych-DS, which allow only letters and digits. Labels of people and protocols are
/// assigned once and stored in the table `label`, so that no later participant gets a published label.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Maps each text to a label of letters and digits that no other text has.
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

/// The labels of a database: the stored ones, then new ones for those without, in the order of codes.
std::vector<GivenLabel> labels_of(sqlite::Connection& database);
/// Stores the new labels of labels_of() within the caller's transaction.
void give_labels(sqlite::Connection& database);
/// Joins the labels of several databases. Those of `first` stay unchanged. Those of `others` are added in
/// turn for owners without one; a label that is taken gets the suffix "x2" and so on.
std::vector<GivenLabel> joined_labels(const std::vector<GivenLabel>& first,
                                      const std::vector<GivenLabel>& others);
void store_labels(sqlite::Connection& database, const std::vector<GivenLabel>& labels);

/// A session with its labels for exports.
struct LabelledSession {
  std::int64_t id = 0;
  std::string person;                      ///< as in session
  std::string participant;                 ///< code
  std::string subject, session, protocol;  ///< labels; session: protocol and visit
};

/// The sessions allowed in a public export, by participant, then in the order of planning. A participant who
/// refused in one session, or was asked and has not answered, is left out with all sessions. base::Error if
/// one has no label (give_labels).
std::vector<LabelledSession> shared_sessions(sqlite::Connection& database);
/// The persons of these sessions (session.person).
std::set<std::string> people_of(const std::vector<LabelledSession>& sessions);

}  // namespace study
