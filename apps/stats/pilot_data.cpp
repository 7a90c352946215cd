#include "apps/stats/pilot_data.hpp"

#include <algorithm>
#include <set>

namespace apps {

namespace {

using study::RatingRow;
using study::Verdict;

bool excludes(ExcludedVerdicts rule, Verdict verdict) {
  if (rule == ExcludedVerdicts::None || verdict == Verdict::Pass) return false;
  return verdict == Verdict::Fail || rule == ExcludedVerdicts::Degraded;
}

/// The one protocol asked for.
stats::Result<std::string> chosen_protocol(const std::vector<RatingRow>& rows, const std::string& wanted) {
  std::map<std::string, std::string> names;
  for (const auto& row : rows) {
    if (row.protocol_sha256.starts_with(wanted)) names[row.protocol_sha256] = row.protocol_name;
  }
  if (rows.empty()) return stats::Refusal{"the database holds no trials"};
  if (names.empty())
    return stats::Refusal{"the database holds no protocol whose SHA-256 begins with " + wanted};
  if (names.size() == 1) return names.begin()->first;
  std::string list;
  for (const auto& [hash, name] : names) list += (list.empty() ? "" : ", ") + name + " " + hash.substr(0, 12);
  return stats::Refusal{"several protocols are never pooled; choose one with --protocol: " + list};
}

/// The one question asked for.
stats::Result<std::string> chosen_question(const std::vector<RatingRow>& rows, const std::string& wanted) {
  std::set<std::string> ids;
  for (const auto& row : rows) {
    if (wanted.empty() || row.question == wanted) ids.insert(row.question);
  }
  if (ids.empty()) return stats::Refusal{"the protocol asks no question '" + wanted + "' on a scale"};
  if (ids.size() == 1) return *ids.begin();
  std::string list;
  for (const auto& id : ids) list += (list.empty() ? "" : ", ") + id;
  return stats::Refusal{"several questions are never pooled; choose one with --question: " + list};
}

void add_rating(PilotData& data, const RatingRow& row, int participant) {
  ++data.used_by_verdict[study::verdict_name(row.timing->verdict)];
  ++data.used_by_grade[std::string(1, static_cast<char>(row.timing->grade))];
  const auto& shown = row.timing->realised;
  data.ratings.push_back({participant, row.nominal.mean, row.nominal.sd, shown.mean, shown.mean_arithmetic,
                          shown.sd, static_cast<double>(*row.rating)});
}

/// Counts a trial that is left out for what it is; false when it is to be analysed. people: some trials that
/// may be analysed were answered by people, which observer models are never pooled with.
bool left_out(PilotData& data, const RatingRow& row, ExcludedVerdicts rule, bool people) {
  int* reason = nullptr;
  if (row.practice) {
    reason = &data.practice;
  } else if (row.repeat) {
    reason = &data.repeat;
  } else if (row.excluded) {
    reason = &data.excluded;
  } else if (row.test_data && !data.test_data) {
    reason = &data.test_left_out;
  } else if (!row.observer.empty() && people) {
    reason = &data.simulated_left_out;
  } else if (!row.rating) {
    reason = &data.unanswered;
  } else if (!row.timing || row.timing->realised.frames == 0) {
    reason = &data.without_timing;
  } else if (excludes(rule, row.timing->verdict)) {
    reason = &data.excluded_by_verdict[study::verdict_name(row.timing->verdict)];
  }
  if (reason) ++*reason;
  return reason != nullptr;
}

}  // namespace

stats::Result<PilotData> select_pilot(const std::vector<RatingRow>& rows, const PilotSelection& selection) {
  const auto protocol = chosen_protocol(rows, selection.protocol);
  if (!protocol) return stats::Refusal{protocol.reason()};
  std::vector<RatingRow> of_protocol;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_protocol),
               [&](const RatingRow& row) { return row.protocol_sha256 == *protocol; });
  const auto question = chosen_question(of_protocol, selection.question);
  if (!question) return stats::Refusal{question.reason()};
  std::erase_if(of_protocol, [&](const RatingRow& row) { return row.question != *question; });
  PilotData data;
  data.protocol_sha256 = *protocol;
  data.protocol_name = of_protocol.front().protocol_name;
  data.scale_min = of_protocol.front().scale_min;
  data.scale_max = of_protocol.front().scale_max;
  data.test_data =
      std::all_of(of_protocol.begin(), of_protocol.end(),
                  [](const RatingRow& row) { return row.test_data || !row.rating; }) &&
      std::any_of(of_protocol.begin(), of_protocol.end(), [](const RatingRow& row) { return row.test_data; });
  const bool people = std::any_of(of_protocol.begin(), of_protocol.end(), [&](const RatingRow& row) {
    return row.rating && row.observer.empty() && (data.test_data || !row.test_data);
  });
  std::map<std::string, int> participants;
  std::set<std::string> simulated;
  for (const auto& row : of_protocol) {
    if (left_out(data, row, selection.exclude, people)) continue;
    const auto index =
        participants.emplace(row.participant, static_cast<int>(participants.size())).first->second;
    if (!row.observer.empty()) simulated.insert(row.participant);
    add_rating(data, row, index);
  }
  data.simulated_participants = static_cast<int>(simulated.size());
  return data;
}

}  // namespace apps
