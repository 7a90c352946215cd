#include "libstudy/store/export_labels.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "stats/base/error.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

std::string letters_of(const std::string& text) {
  std::string letters;
  for (const char c : text) {
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) letters += c;
  }
  return letters;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Assigns distinct labels. Two labels must differ in more than case, because many file systems ignore case.
class Giving {
 public:
  bool has(const std::string& kind, const std::string& owner) const {
    return owners_.contains({kind, owner});
  }
  bool is_taken(const std::string& kind, const std::string& label) const {
    return taken_.contains({kind, lower(label)});
  }
  /// Assigns the wished label to the owner; if the label is taken, adds the suffix x2, x3 and so on.
  void give(const std::string& kind, const std::string& owner, const std::string& wished) {
    const std::string start = wished.empty() ? "x" : wished;
    std::string label = start;
    for (int i = 2; is_taken(kind, label); ++i) label = start + "x" + std::to_string(i);
    owners_.emplace(kind, owner);
    taken_.emplace(kind, lower(label));
    given.push_back({kind, owner, label});
  }

  void reserve(const std::string& kind, const std::string& label) { taken_.emplace(kind, lower(label)); }

  std::vector<GivenLabel> given;

 private:
  std::set<std::pair<std::string, std::string>> owners_, taken_;
};

Giving stored_labels(Connection& database) {
  Giving labels;
  for (Statement row(database, "SELECT kind, owner, label FROM label ORDER BY kind, owner"); row.step();)
    labels.give(row.text(0), row.text(1), row.text(2));
  // The label made from the code of a person who withdrew may be published, so it is not assigned again.
  for (Statement row(database, "SELECT participant FROM tombstone"); row.step();)
    labels.reserve("person", letters_of(row.text(0)));
  return labels;
}

}  // namespace

const std::string& Labels::of(const std::string& text) {
  const auto known = labels_.find(text);
  if (known != labels_.end()) return known->second;
  const std::string letters = letters_of(text);
  std::string label = letters.empty() ? "x" : letters;
  for (int i = 2; !taken_.insert(label).second; ++i) label = letters + "x" + std::to_string(i);
  return labels_[text] = label;
}

std::vector<GivenLabel> labels_of(Connection& database) {
  Giving labels = stored_labels(database);
  // Assigns labels in the same order as earlier versions, which stored no labels and assigned them anew at
  // each export. So labels that these versions published stay the same.
  Statement row(database,
                "SELECT s.person, s.participant, p.sha256, p.name FROM session s JOIN protocol p USING "
                "(protocol_id) ORDER BY s.participant, s.session_id");
  while (row.step()) {
    if (!labels.has("person", row.text(0))) labels.give("person", row.text(0), letters_of(row.text(1)));
    if (labels.has("protocol", row.text(2))) continue;
    const std::string name = letters_of(row.text(3));  // protocols may share a name
    labels.give("protocol", row.text(2),
                labels.is_taken("protocol", name) ? name + letters_of(row.text(2)).substr(0, 6) : name);
  }
  return labels.given;
}

void store_labels(Connection& database, const std::vector<GivenLabel>& labels) {
  Statement insert(database, "INSERT OR IGNORE INTO label VALUES (?,?,?)");
  for (const GivenLabel& one : labels) insert.bind_all(one.kind, one.owner, one.label).run();
}

void give_labels(Connection& database) { store_labels(database, labels_of(database)); }

std::vector<GivenLabel> joined_labels(const std::vector<GivenLabel>& first,
                                      const std::vector<GivenLabel>& others) {
  Giving labels;
  for (const GivenLabel& one : first) labels.give(one.kind, one.owner, one.label);
  for (const GivenLabel& one : others)
    if (!labels.has(one.kind, one.owner)) labels.give(one.kind, one.owner, one.label);
  return labels.given;
}

std::vector<LabelledSession> shared_sessions(Connection& database) {
  std::vector<LabelledSession> sessions;
  Statement row(database,
                "SELECT s.session_id, s.participant, s.visit, s.person, "
                "(SELECT label FROM label WHERE kind = 'person' AND owner = s.person), "
                "(SELECT label FROM label WHERE kind = 'protocol' AND owner = p.sha256) FROM session s "
                "JOIN protocol p USING (protocol_id) JOIN sharing h USING (person) "
                "WHERE h.granted IS NOT 0 ORDER BY s.participant, s.session_id");
  while (row.step()) {
    if (row.is_null(4) || row.is_null(5)) {
      throw base::Error(database.path().string(),
                        "has no export label for participant " + row.text(1) + " or for their protocol",
                        "export again; if this repeats, report it");
    }
    const std::string protocol = row.text(5);
    sessions.push_back({.id = row.integer(0),
                        .person = row.text(3),
                        .participant = row.text(1),
                        .subject = row.text(4),
                        .session = protocol + "v" + row.text(2),
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
