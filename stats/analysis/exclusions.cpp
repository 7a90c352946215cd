#include "stats/analysis/exclusions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace stats {

namespace {

/// All records of one participant on one visit.
struct Visit {
  std::vector<const TrialRecord*> trials, repeats;
  int catches = 0, correct = 0;
  int answers = 0;
};

using VisitKey = std::pair<std::string, int>;

bool answered(const TrialRecord& trial) { return !std::isnan(trial.answer); }

std::string share_text(int part, int whole) { return std::to_string(part) + " of " + std::to_string(whole); }

std::string number_text(double value) { return fmt::format("{:.3g}", value); }

std::map<VisitKey, Visit> by_visit(std::span<const TrialRecord> trials,
                                   std::span<const CatchRecord> catches) {
  std::map<VisitKey, Visit> visits;
  for (const TrialRecord& trial : trials) {
    Visit& visit = visits[{trial.participant, trial.visit}];
    (trial.repeats < 0 ? visit.trials : visit.repeats).push_back(&trial);
    visit.answers += trial.answers;
  }
  for (const CatchRecord& page : catches) {
    Visit& visit = visits[{page.participant, page.visit}];
    ++visit.catches;
    visit.correct += page.correct ? 1 : 0;
  }
  return visits;
}

/// The reason if too few catch pages were answered correctly; empty if enough were, or if the rule does not
/// apply.
std::string fails_catches(const Visit& visit, const ExclusionRules& rules) {
  if (!rules.min_catch_correct || visit.catches == 0) return {};
  if (visit.correct >= *rules.min_catch_correct * visit.catches) return {};
  return "answered " + share_text(visit.correct, visit.catches) + " catch pages correctly, below " +
         number_text(100 * *rules.min_catch_correct) + " %";
}

/// |repeat - original| for each repeated showing with both answers.
std::vector<double> repeat_differences(const Visit& visit) {
  std::vector<double> out;
  for (const TrialRecord* repeat : visit.repeats) {
    const auto original =
        std::find_if(visit.trials.begin(), visit.trials.end(),
                     [&](const TrialRecord* trial) { return trial->position == repeat->repeats; });
    if (original == visit.trials.end() || !answered(**original) || !answered(*repeat)) continue;
    out.push_back(std::abs(repeat->answer - (*original)->answer));
  }
  return out;
}

std::string fails_repeats(const Visit& visit, const ExclusionRules& rules, bool pairs) {
  const auto differences = repeat_differences(visit);
  if (differences.empty()) return {};
  const int n = static_cast<int>(differences.size());
  if (pairs) {
    const int alike = static_cast<int>(std::count(differences.begin(), differences.end(), 0.0));
    if (!rules.min_repeat_agreement || alike >= *rules.min_repeat_agreement * n) return {};
    return "answered " + share_text(alike, n) + " repeated pairs as before, below " +
           number_text(100 * *rules.min_repeat_agreement) + " %";
  }
  double sum = 0;
  for (const double difference : differences) sum += difference;
  if (!rules.max_repeat_difference || sum / n <= *rules.max_repeat_difference) return {};
  return "repeated showings were rated " + number_text(sum / n) + " points apart on average, above " +
         number_text(*rules.max_repeat_difference);
}

std::string straight_lines(const Visit& visit, const ExclusionRules& rules, bool pairs) {
  if (rules.straight_lining_answers <= 0) return {};
  std::vector<double> given;
  for (const TrialRecord* trial : visit.trials) {
    if (answered(*trial)) given.push_back(trial->answer);
  }
  if (static_cast<int>(given.size()) < rules.straight_lining_answers) return {};
  if (std::adjacent_find(given.begin(), given.end(), std::not_equal_to<>()) != given.end()) return {};
  const std::string all = "all " + std::to_string(given.size());
  if (pairs)
    return "chose the " + std::string(given[0] == 1 ? "first" : "second") + " interval in " + all + " pairs";
  return "gave " + number_text(given[0]) + " in " + all + " main ratings";
}

std::string is_incomplete(const Visit& visit, const ExclusionRules& rules) {
  const int planned = static_cast<int>(visit.trials.size());
  const auto done = static_cast<int>(std::count_if(
      visit.trials.begin(), visit.trials.end(), [](const TrialRecord* trial) { return answered(*trial); }));
  if (done >= rules.min_answered * planned) return {};
  return "answered " + share_text(done, planned) + " trials, below " + number_text(100 * rules.min_answered) +
         " %";
}

/// The first rule that excludes the whole visit, and its reason. The reason is empty if no rule does.
std::pair<std::string, std::string> visit_rule(const Visit& visit, const ExclusionRules& rules, bool pairs) {
  std::string reason = fails_catches(visit, rules);
  if (!reason.empty()) return {"catch", reason};
  reason = fails_repeats(visit, rules, pairs);
  if (!reason.empty()) return {"repeat", reason};
  reason = straight_lines(visit, rules, pairs);
  if (!reason.empty()) return {"straight_lining", reason};
  return {"incomplete", is_incomplete(visit, rules)};
}

bool fails_timing(const TrialRecord& trial, TimingRule rule) {
  if (rule == TimingRule::None) return false;
  return trial.timing == TrialTiming::Fail ||
         (rule == TimingRule::Degraded && trial.timing == TrialTiming::Degraded);
}

void exclude_trials(std::vector<Exclusion>& out, const Visit& visit, const ExclusionRules& rules) {
  for (const auto* list : {&visit.trials, &visit.repeats}) {
    for (const TrialRecord* trial : *list) {
      Exclusion exclusion{.participant = trial->participant,
                          .visit = trial->visit,
                          .position = trial->position,
                          .rule = "",
                          .reason = "",
                          .answers = trial->answers};
      if (!trial->by_experimenter.empty()) {
        exclusion.rule = "experimenter";
        exclusion.reason = trial->by_experimenter;
      } else if (trial->interrupted) {
        exclusion.rule = "interruption";
        exclusion.reason = "interrupted, and the protocol shows no trial again";
      } else if (fails_timing(*trial, rules.timing)) {
        exclusion.rule = "timing";
        exclusion.reason = std::string("timing verdict ") +
                           (trial->timing == TrialTiming::Fail ? "fail" : "degraded") +
                           (trial->timing_reason.empty() ? "" : ": " + trial->timing_reason);
      }
      if (!exclusion.rule.empty()) out.push_back(std::move(exclusion));
    }
  }
}

}  // namespace

std::vector<Exclusion> find_exclusions(std::span<const TrialRecord> trials,
                                       std::span<const CatchRecord> catches, const ExclusionRules& rules,
                                       bool pairs) {
  std::vector<Exclusion> out;
  for (const auto& [key, visit] : by_visit(trials, catches)) {
    exclude_trials(out, visit, rules);
    auto [rule, reason] = visit_rule(visit, rules, pairs);
    if (reason.empty()) continue;
    int left = visit.answers;  // answers that no exclusion of a single trial has counted
    for (const Exclusion& one : out) {
      if (one.participant == key.first && one.visit == key.second) left -= one.answers;
    }
    out.push_back({.participant = key.first,
                   .visit = key.second,
                   .rule = std::move(rule),
                   .reason = std::move(reason),
                   .answers = left});
  }
  std::stable_sort(out.begin(), out.end(), [](const Exclusion& a, const Exclusion& b) {
    return std::tie(a.participant, a.visit, a.position) < std::tie(b.participant, b.visit, b.position);
  });
  return out;
}

bool is_excluded(std::span<const Exclusion> exclusions, const std::string& participant, int visit,
                 int position) {
  return std::any_of(exclusions.begin(), exclusions.end(), [&](const Exclusion& one) {
    return one.participant == participant && one.visit == visit &&
           (one.position == -1 || one.position == position);
  });
}

}  // namespace stats
