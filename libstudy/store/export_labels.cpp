#include "libstudy/store/export_labels.hpp"

namespace study {

const std::string& Labels::of(const std::string& text) {
  const auto known = labels_.find(text);
  if (known != labels_.end()) return known->second;
  std::string letters;
  for (const char c : text) {
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) letters += c;
  }
  std::string label = letters.empty() ? "x" : letters;
  for (int i = 2; !taken_.insert(label).second; ++i) label = letters + "x" + std::to_string(i);
  return labels_[text] = label;
}

std::vector<LabelledSession> shared_sessions(sqlite::Connection& database) {
  Labels people, protocols, visits;
  std::vector<LabelledSession> sessions;
  sqlite::Statement row(
      database,
      "SELECT s.session_id, s.participant, p.name, p.sha256, s.visit, s.person FROM session s "
      "JOIN protocol p USING (protocol_id) JOIN sharing h USING (person) "
      "WHERE h.granted IS NOT 0 ORDER BY s.participant, s.session_id");
  std::map<std::string, std::string> name_of;  // by hash: two texts under one name are two data sets
  while (row.step()) {
    const std::string sha256 = row.text(3);
    if (!name_of.contains(sha256)) {
      bool fresh = true;
      for (const auto& [other, label] : name_of) fresh = fresh && label != protocols.of(row.text(2));
      name_of[sha256] = fresh ? protocols.of(row.text(2)) : protocols.of(row.text(2) + sha256.substr(0, 6));
    }
    const std::string& protocol = name_of[sha256];
    sessions.push_back({.id = row.integer(0),
                        .person = row.text(5),
                        .participant = row.text(1),
                        .subject = people.of(row.text(1)),
                        .session = visits.of(protocol + "v" + row.text(4)),
                        .protocol = protocol});
  }
  return sessions;
}

std::set<std::string> people_of(const std::vector<LabelledSession>& sessions) {
  std::set<std::string> people;
  for (const LabelledSession& session : sessions) people.insert(session.person);
  return people;
}

}  // namespace study
