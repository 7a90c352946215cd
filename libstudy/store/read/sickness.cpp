#include "libstudy/store/read/sickness.hpp"

#include <algorithm>
#include <charconv>

#include "libstudy/store/open_study.hpp"
#include "stats/base/error.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* sickness_answers_sql =
    "SELECT s.session_id, p.name, p.sha256, s.participant, s.visit, coalesce(s.observer, ''), "
    "s.test_data OR p.test_data, u.position, u.block, t.position, r.attempt, q.code, r.score, "
    "r.answered_utc, "
    "1440 * (julianday(r.answered_utc) - (SELECT min(julianday(f.answered_utc)) FROM response f "
    "JOIN unit v USING (unit_id) WHERE v.session_id = s.session_id)), "
    "NOT EXISTS (SELECT 1 FROM unit v WHERE v.session_id = s.session_id AND v.trial_id IS NOT NULL "
    "AND v.position <= u.position), q.scale_min, q.scale_max "
    "FROM response r JOIN unit u USING (unit_id) JOIN session s USING (session_id) "
    "JOIN protocol p USING (protocol_id) JOIN question q USING (question_id) "
    "LEFT JOIN trial t ON t.trial_id = u.trial_id "
    "WHERE q.code = 'fms' OR q.code LIKE 'ssq\\_%' ESCAPE '\\' "
    "ORDER BY p.protocol_id, s.participant, s.visit, r.response_id";

/// The 0-based index of an SSQ item from its question id: "ssq_7" gives 6. base::Error if there is no such
/// item.
std::size_t item_of(const std::string& code, const std::string& shown) {
  int number = 0;
  const char* const end = code.data() + code.size();
  const auto read = std::from_chars(code.data() + 4, end, number);
  if (read.ptr != end || number < 1 || number > stats::ssq_item_count)
    throw base::Error(shown + ", question " + code, "is no item of the SSQ",
                      "restore the database from a backup");
  return static_cast<std::size_t>(number - 1);
}

class SicknessReader {
 public:
  explicit SicknessReader(sqlite::Connection& database)
      : row_(database, sickness_answers_sql), shown_(database.path().string()) {}

  std::vector<SicknessSession> sessions() {
    while (row_.step()) {
      if (row_.text(11) != "fms")
        add_ssq();
      else if (!row_.is_null(12))
        add_fms();
    }
    return std::move(sessions_);
  }

 private:
  SicknessSession& session() {
    if (!sessions_.empty() && sessions_.back().id == row_.integer(0)) return sessions_.back();
    SicknessSession& next = sessions_.emplace_back();
    next.id = row_.integer(0);
    next.protocol_name = row_.text(1);
    next.protocol_sha256 = row_.text(2);
    next.participant = row_.text(3);
    next.visit = static_cast<int>(row_.integer(4));
    next.observer = row_.text(5);
    next.test_data = row_.integer(6) != 0;
    showing_ = {};
    return next;
  }

  void add_ssq() {
    SicknessSession& session = this->session();
    const std::pair showing{row_.integer(7), row_.integer(10)};
    if (showing_ != showing) {
      showing_ = showing;
      SsqPage page;
      page.position = static_cast<int>(row_.integer(7));
      page.block = row_.text(8);
      page.before = row_.integer(15) != 0;
      session.ssq.push_back(page);
    }
    session.ssq.back().answered_utc = row_.text(13);
    const std::size_t item = item_of(row_.text(11), shown_);
    if (!row_.is_null(12)) session.ssq.back().answers[item] = score();
  }

  void add_fms() {
    FmsAnswer answer;
    answer.position = static_cast<int>(row_.integer(7));
    answer.block = row_.text(8);
    if (!row_.is_null(9)) answer.trial = static_cast<int>(row_.integer(9));
    answer.answered_utc = row_.text(13);
    answer.minutes = row_.real(14);
    answer.score = score();
    session().fms.push_back(answer);
  }

  /// The score of the current answer. base::Error if it is outside the question's scale: 0 to ssq_item_max
  /// for the SSQ, the protocol's scale for the FMS.
  int score() const {
    const bool fms = row_.text(11) == "fms";
    const std::int64_t score = row_.integer(12), least = fms ? row_.integer(16) : 0,
                       most = fms ? row_.integer(17) : stats::ssq_item_max;
    if (score < least || score > most)
      throw base::Error(shown_ + ", answer of " + row_.text(3) + " to " + row_.text(11),
                        "is " + std::to_string(score) + ", outside " + std::to_string(least) + " to " +
                            std::to_string(most),
                        "restore the database from a backup");
    return static_cast<int>(score);
  }

  Statement row_;
  std::string shown_;
  std::vector<SicknessSession> sessions_;
  std::optional<std::pair<std::int64_t, std::int64_t>> showing_;  ///< current SSQ page: position and attempt
};

}  // namespace

const SsqPage* SicknessSession::ssq_before() const {
  const auto last = std::find_if(ssq.rbegin(), ssq.rend(), [](const SsqPage& page) { return page.before; });
  return last == ssq.rend() ? nullptr : &*last;
}

const SsqPage* SicknessSession::ssq_after() const {
  return ssq.empty() || ssq.back().before ? nullptr : &ssq.back();
}

std::vector<SicknessSession> read_sickness(sqlite::Connection& database) {
  return SicknessReader(database).sessions();
}

std::vector<SicknessSession> read_sickness(const StudyFile& study) {
  const auto database = open_study(study).database;
  return read_sickness(*database);
}

}  // namespace study
