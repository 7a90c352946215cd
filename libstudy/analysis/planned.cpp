#include "libstudy/analysis/planned.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "stats/analysis/mixed_scores.hpp"

namespace study {

namespace {

using Key = std::tuple<int, int, int>;  // participant, visit, position

int index_in(const std::vector<std::string>& list, const std::string& item) {
  const auto found = std::find(list.begin(), list.end(), item);
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

Key key_of_report(const Report& report) { return {report.participant, report.visit, report.position}; }

/// The session's trials without practice and repeats; periods are numbered from 0 within the visit.
std::vector<Report> planned_of(const TaskSession& session, const TaskData& data, int participant) {
  std::vector<Report> out;
  std::vector<int> blocks;
  for (const auto& trial : session.trials) {
    if (trial.kind != "stimulus") continue;
    const auto& what = trial.first.what;
    out.push_back({participant,
                   session.visit,
                   trial.position,
                   index_in(data.protocol.scenes, what.scene),
                   index_in(data.protocol.n_stars, what.n_star),
                   index_in(data.protocol.methods, treatment_name(what)),
                   0,
                   {}});
    blocks.push_back(out.back().scene * static_cast<int>(data.protocol.n_stars.size()) + out.back().n_star);
  }
  const auto periods = stats::periods_of(blocks);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].period = periods[i];
  return out;
}

/// Numbers periods across visits: those of later visits follow those of earlier ones.
void count_over_visits(std::map<Key, Report>& planned) {
  std::set<std::pair<int, int>> periods;
  for (const auto& [key, report] : planned) periods.insert({report.visit, report.period});
  for (auto& [key, report] : planned)
    report.period =
        static_cast<int>(std::distance(periods.begin(), periods.find({report.visit, report.period})));
}

}  // namespace

void add_planned(TaskData& data) {
  std::map<Key, Report> planned;
  for (const auto& session : data.protocol.sessions) {
    const int participant = index_in(data.participants, session.participant);
    if (participant < 0) continue;
    for (const Report& report : planned_of(session, data, participant))
      planned[key_of_report(report)] = report;
  }
  count_over_visits(planned);
  for (Report& report : data.reports) {
    const auto found = planned.find(key_of_report(report));
    if (found == planned.end()) continue;
    report.period = found->second.period;
    planned.erase(found);
  }
  for (const auto& [key, report] : planned) data.unanswered.push_back(report);
}

}  // namespace study
