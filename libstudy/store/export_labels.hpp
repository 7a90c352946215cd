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
  std::string participant;                 ///< code
  std::string subject, session, protocol;  ///< labels; session: protocol and visit
};

/// All sessions, by participant, then in the order of planning.
std::vector<LabelledSession> labelled_sessions(sqlite::Connection& database);

}  // namespace study
