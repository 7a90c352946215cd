#pragma once
/// Names that BIDS and Psych-DS allow: letters and digits alone.

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

/// A session as exports name it.
struct LabelledSession {
  std::int64_t id = 0;
  std::string person;                      ///< as in session
  std::string participant;                 ///< code
  std::string subject, session, protocol;  ///< labels; session: protocol and visit
};

/// The sessions that may stand in a public export, by participant, then in the order of planning. Whoever
/// refused that in one session, or was asked and has not answered, is left out with all of them.
std::vector<LabelledSession> shared_sessions(sqlite::Connection& database);
/// Whose they are: session.person.
std::set<std::string> people_of(const std::vector<LabelledSession>& sessions);

}  // namespace study
