#pragma once
/// Labels for exports in BIDS and Psych-DS, whose names allow only letters and digits. A label of a person or
/// a protocol is assigned once and stored in the table `label`. So later exports use the same labels. The
/// label made from the code of a person who withdrew is not assigned again.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Assigns each text a label of letters and digits; different texts get different labels.
class Labels {
 public:
  const std::string& of(const std::string& text);

 private:
  std::map<std::string, std::string> labels_;
  std::set<std::string> taken_;
};

/// A row of the table `label`. kind: "person" or "protocol"; owner: session.person, or the SHA-256 of the
/// protocol.
struct GivenLabel {
  std::string kind, owner, label;
};

/// All labels of a database: the stored ones, then new labels for people and protocols that have none. New
/// labels are assigned in the order of participant codes. Does not store them.
std::vector<GivenLabel> labels_of(sqlite::Connection& database);
/// Stores the new labels of labels_of() within the caller's transaction.
void give_labels(sqlite::Connection& database);
/// Joins the labels of several databases. Labels in `first` stay unchanged. Labels in `others` are added in
/// turn if their owner has none yet; a label that another owner has gets the suffix "x2", "x3" and so on.
std::vector<GivenLabel> joined_labels(const std::vector<GivenLabel>& first,
                                      const std::vector<GivenLabel>& others);
void store_labels(sqlite::Connection& database, const std::vector<GivenLabel>& labels);

/// A session with its labels for exports.
struct LabelledSession {
  std::int64_t id = 0;
  std::string person;                      ///< identifier of the person (column session.person)
  std::string participant;                 ///< participant code
  std::string subject, session, protocol;  ///< labels; session: "<protocol label>v<visit>"
};

/// The sessions allowed in a public export, by participant code, then in the order of planning. If a
/// participant refused sharing in any session, or was asked and has not answered, all sessions of the
/// participant are omitted. Participants who were never asked are included. base::Error if a person or a
/// protocol has no stored label (give_labels()).
std::vector<LabelledSession> shared_sessions(sqlite::Connection& database);
/// The persons (session.person) of these sessions.
std::set<std::string> people_of(const std::vector<LabelledSession>& sessions);

}  // namespace study
