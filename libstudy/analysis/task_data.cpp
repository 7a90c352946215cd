#include "libstudy/analysis/task_data.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/analysis/trial_record.hpp"
#include "stats/analysis/mixed_scores.hpp"
#include "stats/base/text.hpp"
#include "stats/base/utc.hpp"

namespace study {

namespace {

using Key = std::tuple<int, int, int>;  // participant, visit, position of the trial

int index_in(const std::vector<std::string>& list, const std::string& item) {
  const auto found = std::find(list.begin(), list.end(), item);
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

Key key_of_report(const Report& report) { return {report.participant, report.visit, report.position}; }

/// The session's trials without practice and repeats, as reports without answers. Periods are numbered from 0
/// within the visit.
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

/// Renumbers the periods so that the numbers of a later visit continue after those of the earlier visits.
void count_over_visits(std::map<Key, Report>& planned) {
  std::set<std::pair<int, int>> periods;
  for (const auto& [key, report] : planned) periods.insert({report.visit, report.period});
  for (auto& [key, report] : planned)
    report.period =
        static_cast<int>(std::distance(periods.begin(), periods.find({report.visit, report.period})));
}

/// Sets the period of each report. Adds the planned trials without a report to `unanswered`.
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

using study::TaskSession;
using study::TaskTrial;

/// The setting in words: "Ours n_star=16384 ... (setting SHA-256 ...)".
std::string setting_words(const RunSetting& setting) {
  const auto file = sim::parse_setting_file(setting.text, "setting " + setting.sha256.substr(0, 12));
  const std::string words =
      sim::to_text(file.setting);  // its first word, the scene in which the setting was chosen, is cut
  return words.substr(words.find(' ') + 1) + " (setting " + setting.sha256 + ")";
}

/// Largest step back of a clock that is not doubted, in s: smaller steps are normal corrections.
constexpr std::int64_t small_step_s = 3600;

std::optional<DoubtfulTime> doubt_about(const TaskSession& session) {
  const auto told_s = base::seconds_of_utc(session.first_answer_utc);
  const auto least_s = base::seconds_of_utc(session.not_before_utc);
  const bool impossible =
      !session.first_answer_utc.empty() && session.first_answer_utc < base::before_vip_lab_utc;
  const bool back = told_s && least_s && *told_s < *least_s - small_step_s;
  // Answers of another program are older than their import.
  if (!session.imported_from.empty() || session.not_before_utc.empty() || (!impossible && !back)) return {};
  return DoubtfulTime{session.participant, session.station, session.first_answer_utc, session.not_before_utc,
                      impossible};
}

class Collector {
 public:
  explicit Collector(TaskData& data) : data_(data) {}

  void collect(const stats::ExclusionRules& rules) {
    leave_out_sessions();
    data_.exclusions = find_exclusions(data_.protocol, data_.question, rules);
    for (const TaskSession& session : data_.protocol.sessions) add_session(session);
    count_people();
    data_.flow.analysed = static_cast<int>(data_.participants.size());
  }

 private:
  /// Removes test data if real data exist, and sessions of observer models if a person answered. Then counts
  /// the sessions by state and collects the times of first answers.
  void leave_out_sessions() {
    auto& sessions = data_.protocol.sessions;
    data_.test_data =
        !has_real_answers(data_.protocol) &&
        std::any_of(sessions.begin(), sessions.end(), [](const auto& one) { return one.test_data; });
    data_.flow.test_left_out = static_cast<int>(
        std::erase_if(sessions, [&](const TaskSession& one) { return one.test_data && !data_.test_data; }));
    const bool people = std::any_of(sessions.begin(), sessions.end(), [](const TaskSession& one) {
      return one.observer.empty() && has_answers(one);
    });
    data_.flow.simulated_left_out = static_cast<int>(
        std::erase_if(sessions, [&](const TaskSession& one) { return people && !one.observer.empty(); }));
    for (const TaskSession& session : sessions) {
      ++data_.flow.by_state[session.state];
      const std::string& utc = session.first_answer_utc;
      if (const auto doubt = doubt_about(session)) {
        data_.doubtful_times.push_back(*doubt);
        continue;
      }
      if (!utc.empty() && (data_.first_answer_utc.empty() || utc < data_.first_answer_utc))
        data_.first_answer_utc = utc;
    }
    data_.flow.started = static_cast<int>(sessions.size()) - data_.flow.by_state["planned"];
  }

  void add_session(const TaskSession& session) {
    if (session.state != "planned") people_.insert(session.participant);
    if (is_simulated(session)) {
      add_once(data_.simulated, session.participant);
      add_once(data_.observers, session.observer);
    }
    bool counted = false;
    for (const TaskTrial& trial : session.trials) counted = add_trial(session, trial) || counted;
    if (!counted) return;
    ++data_.gaze[session.gaze_source];
    if (session.gaze_source == "tracked" && !session.tracker.empty()) ++data_.trackers[session.tracker];
    ++data_.stations[session.station];
    ++data_.displays[session.display];
    if (!session.angles.empty()) ++data_.angles[session.angles];
    if (!session.imported_from.empty())
      data_.imported[session.imported_from].push_back(session.source_sha256);
    for (const auto& setting : session.settings) ++data_.settings[setting_words(setting)];
    if (!session.unblinded.empty()) ++data_.unblinded[session.unblinded];
    if (!session.mixed_pictures.empty()) ++data_.mixed_pictures[session.mixed_pictures];
  }

  /// True if the question measures a reaction time and the participant did not press in time. The answer's
  /// time is then the timeout.
  bool too_late(const TaskAnswer& answer) const {
    return answer.score == 0 && std::any_of(data_.protocol.questions.begin(), data_.protocol.questions.end(),
                                            [&](const Question& one) {
                                              return one.id == answer.question && traits_of(one.kind).timed;
                                            });
  }

  /// Counts the trial and stores its answers. Returns true if an answer about the trial is analysed.
  bool add_trial(const TaskSession& session, const TaskTrial& trial) {
    if (trial.kind == "practice") {
      ++data_.flow.practice;
      return false;
    }
    const bool repeat = trial.kind == "repeat";
    const bool excluded =
        stats::is_excluded(data_.exclusions, session.participant, session.visit, trial.position);
    const auto record = record_of(session, trial, data_.question);
    const bool analysed = !repeat && record.answers > 0 && !excluded;
    add_showings(session, trial, analysed);
    if (repeat) {
      ++data_.flow.repeat;
      if (!excluded) add_repeat(session, trial);
      return false;
    }
    ++data_.flow.trials_planned;
    if (record.answers == 0) return false;
    // In a pilot and in Task 2, a participant who answered only other questions than the analysed one is not
    // in answered_ and so never counts as excluded.
    if (record.answer == record.answer || data_.task == TaskKind::Task1 || data_.task == TaskKind::Own)
      answered_.insert(session.participant);
    ++data_.flow.trials_answered;
    ++(excluded ? data_.flow.trials_excluded : data_.flow.trials_analysed);
    if (!analysed) return false;
    add_answered(session, trial);
    for (const TaskAnswer& answer : trial.answers)
      if (answer.response_time_s && !too_late(answer))
        data_.response_times[answer.question].push_back(*answer.response_time_s);
    return add_answer(session, trial, record.answer);
  }

  void add_answered(const TaskSession& session, const TaskTrial& trial) {
    AnsweredTrial answered;
    answered.participant = session.participant;
    answered.first_cell = trial.first.cell;
    if (trial.second) answered.second_cell = trial.second->cell;
    answered.first = trial.first.what;
    answered.first_nominal = trial.first.nominal;
    if (trial.second) {
      answered.second = trial.second->what;
      answered.second_nominal = trial.second->nominal;
    }
    answered.answers = trial.answers;
    data_.answered.push_back(std::move(answered));
  }

  bool add_answer(const TaskSession& session, const TaskTrial& trial, double answer) {
    if (data_.task == TaskKind::Task1) return add_report(session, trial);
    if (data_.task == TaskKind::Own) return person(session) >= 0;
    if (answer != answer) return false;
    data_.task == TaskKind::Task2 ? add_choice(session, trial, answer) : add_rating(session, trial, answer);
    return true;
  }

  void add_repeat(const TaskSession& session, const TaskTrial& repeat) {
    if (!repeat.repeats ||
        stats::is_excluded(data_.exclusions, session.participant, session.visit, *repeat.repeats))
      return;
    for (const TaskTrial& original : session.trials) {
      if (original.position != *repeat.repeats) continue;
      for (const Question& question : data_.protocol.questions) {
        const double before = answer_to(original, question), after = answer_to(repeat, question);
        if (before == before && after == after) data_.repeats[question.id].push_back({before, after});
      }
    }
  }

  void add_showings(const TaskSession& session, const TaskTrial& trial, bool analysed) {
    if (trial.first.played) data_.showings.push_back({trial.first, analysed, session.station});
    if (trial.second && trial.second->played)
      data_.showings.push_back({*trial.second, analysed, session.station});
  }

  bool add_report(const TaskSession& session, const TaskTrial& trial) {
    Report report{person(session), session.visit, trial.position, 0, 0, 0, 0, {}};
    report.scene = index_of(data_.protocol.scenes, trial.first.what.scene);
    report.n_star = index_of(data_.protocol.n_stars, trial.first.what.n_star);
    report.method = index_of(data_.protocol.methods, treatment_name(trial.first.what));
    for (const TaskAnswer& answer : trial.answers) {
      if (answer.score) report.answers[answer.question] = *answer.score;
    }
    data_.reports.push_back(std::move(report));
    return true;
  }

  void add_choice(const TaskSession& session, const TaskTrial& trial, double interval) {
    stats::PairChoice choice;
    choice.participant = person(session);
    choice.scene = index_of(data_.protocol.scenes, trial.first.what.scene);
    choice.first = index_of(data_.protocol.methods, treatment_name(trial.first.what));
    choice.second = index_of(data_.protocol.methods, treatment_name(trial.second->what));
    choice.first_chosen = interval == 1;
    choice.position = trial.position;
    data_.choices.push_back(choice);
  }

  void add_rating(const TaskSession& session, const TaskTrial& trial, double score) {
    const auto& nominal = trial.first.nominal;
    stats::FpsMoments shown = trial.first.realised;
    if (!trial.first.has_rates()) {
      shown.mean = shown.mean_arithmetic = nominal.mean;
      shown.sd = nominal.sd;
      ++data_.asked_rates;
    } else {
      ++(trial.first.framed ? data_.recorded_rates : data_.stated_rates);
    }
    data_.ratings.push_back({person(session), nominal.mean, nominal.sd, shown.mean, shown.mean_arithmetic,
                             shown.sd, score, trial.position});
  }

  int person(const TaskSession& session) {
    add_once(data_.participants, session.participant);
    return index_of(data_.participants, session.participant);
  }

  static void add_once(std::vector<std::string>& list, const std::string& item) {
    if (index_of(list, item) < 0) list.push_back(item);
  }

  static int index_of(const std::vector<std::string>& list, const std::string& item) {
    const auto found = std::find(list.begin(), list.end(), item);
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  }

  void count_people() {
    data_.flow.participants = static_cast<int>(people_.size());
    data_.flow.no_answer = static_cast<int>(people_.size() - answered_.size());
    data_.flow.excluded_visits =
        static_cast<int>(std::count_if(data_.exclusions.begin(), data_.exclusions.end(),
                                       [](const stats::Exclusion& one) { return one.position < 0; }));
    data_.flow.excluded_participants =
        static_cast<int>(std::count_if(answered_.begin(), answered_.end(), [&](const std::string& code) {
          return index_of(data_.participants, code) < 0;
        }));
  }

  TaskData& data_;
  std::set<std::string> people_, answered_;  ///< codes of all participants, and of participants with an
                                             ///< answer for the analysis before exclusions
};

}  // namespace

std::string TaskData::gaze_problem() const {
  int sessions = 0;
  std::string sources;
  for (const auto& [source, n] : gaze) {
    sessions += n;
    if (source != "tracked") sources += (sources.empty() ? "" : ", ") + source + " in " + std::to_string(n);
  }
  if (sources.empty()) return {};
  return "gaze was not tracked in every session (" + sources + " of " + std::to_string(sessions) +
         "), and what the methods refine depends on it";
}

std::string TaskData::rates_words() const {
  std::vector<std::string> kinds;
  if (recorded_rates > 0) kinds.emplace_back("realised");
  if (stated_rates > 0) kinds.emplace_back("stated");
  if (asked_rates > 0) kinds.emplace_back("asked");
  return base::joined(kinds);
}

std::string TaskData::imported_words() const {
  std::string out;
  for (const auto& [tool, sessions] : imported) {
    std::string hashes;
    for (const std::string& hash : std::set<std::string>(sessions.begin(), sessions.end()))
      hashes += (hashes.empty() ? "" : ", ") + hash.substr(0, 12);
    out += (out.empty() ? "" : "; ") + std::to_string(sessions.size()) +
           (sessions.size() == 1 ? " session from " : " sessions from ") + tool +
           " (SHA-256 of the sources " + hashes + ")";
  }
  return out;
}

TaskData collect_task(const TaskStudy& study, const ChosenTask& chosen, const stats::ExclusionRules& rules) {
  TaskData data;
  data.task = chosen.own ? TaskKind::Own : kind_of(chosen.protocol);
  data.protocol = chosen.protocol;
  data.set_aside = chosen.set_aside;
  for (const SetAside& one : chosen.set_aside) data.flow.protocols_left_out += one.sessions;
  data.question = chosen.question;
  for (const std::string& scene : data.protocol.scenes) data.scenes.push_back(scene_name(scene));
  data.flow.withdrawn = study.withdrawn;
  Collector(data).collect(rules);
  if (data.task == TaskKind::Task1) add_planned(data);
  return data;
}

stats::Result<TaskData> collect_task(const TaskStudy& study, const TaskSelection& selection) {
  const auto chosen = choose_task(study, selection);
  if (!chosen) return stats::Refusal{chosen.reason()};
  return collect_task(study, *chosen, selection.plan.exclusions);
}

std::string nothing_counts(const TaskData& data) {
  if (!data.participants.empty()) return {};
  return "no answer counts: " + std::to_string(data.flow.started) + " sessions of protocol " +
         data.protocol.name + ", " + std::to_string(data.flow.trials_answered) + " trials answered, " +
         std::to_string(data.flow.trials_excluded) + " excluded";
}

stats::Result<TaskData> select_task(const TaskStudy& study, const TaskSelection& selection) {
  const auto data = collect_task(study, selection);
  if (!data) return stats::Refusal{data.reason()};
  const std::string nothing = nothing_counts(*data);
  if (!nothing.empty()) return stats::Refusal{nothing};
  return data;
}

std::string scene_name(const std::string& scene) { return std::filesystem::path(scene).stem().string(); }

}  // namespace study
