#include "libstudy/analysis/tasks/sickness_json.hpp"

#include <algorithm>
#include <map>

#include "libstudy/analysis/tasks/task1_json.hpp"
#include "stats/analysis/sickness.hpp"

namespace study {

namespace {

using Sessions = std::vector<const SicknessSession*>;
/// Sessions by participant code, in the order of visits.
using People = std::map<std::string, Sessions>;

bool is_simulated(const SicknessSession& session) { return !session.observer.empty(); }

Json summary_json(const stats::Result<stats::Description>& summary) {
  if (!summary) return {{"n", 0}, {"reason", summary.reason()}};
  return {{"n", summary->n},           {"mean", summary->mean}, {"sd", json_number(summary->sd)},
          {"median", summary->median}, {"q1", summary->q25},    {"q3", summary->q75},
          {"min", summary->min},       {"max", summary->max}};
}

Json change_json(const stats::SicknessChange& change) {
  Json json = summary_json(change.change);
  json["n_missing"] = change.n_missing;
  json["bca"] = change.bootstrap ? json_interval(change.bootstrap->bca.ci) : Json();
  if (!change.bootstrap) json["bca_reason"] = change.bootstrap.reason();
  json["wilcoxon"] = json_result(change.ranks, signed_rank_json);
  return json;
}

/// One person's mean score before and after, over the sessions that have both scores. If no session has both,
/// `before` is the mean over the sessions with a score before, and `after` over those with a score after.
struct Occasions {
  stats::ExactMean before, after;
};

void add(stats::ExactMean& mean, double value) {
  const bool first = mean.sum != mean.sum;
  mean.sum = first ? value : mean.sum + value;
  mean.count = first ? 1 : mean.count + 1;
}

Occasions occasion_means(const std::vector<std::array<std::optional<double>, 2>>& sessions) {
  const bool paired =
      std::any_of(sessions.begin(), sessions.end(), [](const auto& one) { return one[0] && one[1]; });
  Occasions out;
  for (const auto& [before, after] : sessions) {
    if (paired && !(before && after)) continue;
    if (before) add(out.before, *before);
    if (after) add(out.after, *after);
  }
  return out;
}

std::optional<double> sum_of(const SsqPage* page, stats::SsqScale scale) {
  if (!page) return {};
  return stats::ssq_sum(scale, page->answers);
}

Occasions ssq_occasions(const Sessions& sessions, stats::SsqScale scale) {
  std::vector<std::array<std::optional<double>, 2>> sums;
  for (const auto* session : sessions)
    sums.push_back({sum_of(session->ssq_before(), scale), sum_of(session->ssq_after(), scale)});
  return occasion_means(sums);
}

Occasions fms_occasions(const Sessions& sessions) {
  std::vector<std::array<std::optional<double>, 2>> ends;
  for (const auto* session : sessions) {
    // The first answer is compared with the last one, so a session needs two.
    if (session->fms.size() > 1) ends.push_back({session->fms.front().score, session->fms.back().score});
  }
  return occasion_means(ends);
}

template <class Occasion>
stats::SicknessChange compare(const People& people, double weight, const stats::AnalysisPlan& plan,
                              Occasion occasion) {
  std::vector<stats::ExactMean> before, after;
  for (const auto& [code, sessions] : people) {
    const Occasions one = occasion(sessions);
    before.push_back(one.before);
    after.push_back(one.after);
  }
  return stats::compare_sickness(before, after, weight, plan);
}

std::string label_of(stats::SsqScale scale) {
  std::string label = stats::ssq_name(scale);
  label[0] = static_cast<char>(label[0] - 'a' + 'A');
  return label;
}

Json ssq_json(const People& people, const stats::AnalysisPlan& plan) {
  int pages = 0, before = 0, incomplete = 0;
  for (const auto& [code, sessions] : people) {
    for (const auto* session : sessions) {
      pages += static_cast<int>(session->ssq.size());
      before += static_cast<int>(std::count_if(session->ssq.begin(), session->ssq.end(),
                                               [](const SsqPage& page) { return page.before; }));
      incomplete +=
          static_cast<int>(std::count_if(session->ssq.begin(), session->ssq.end(), [](const SsqPage& page) {
            return !stats::ssq_sum(stats::SsqScale::Total, page.answers);
          }));
    }
  }
  if (pages == 0) return {};
  Json json{{"pages", pages},
            {"pages_before", before},
            {"pages_after", pages - before},
            {"incomplete", incomplete},
            {"scores", Json::array()}};
  stats::SsqAnswers worst;
  worst.fill(stats::ssq_item_max);
  for (const stats::SsqScale scale : stats::ssq_scales) {
    const auto change = compare(people, stats::ssq_weight(scale), plan,
                                [&](const Sessions& sessions) { return ssq_occasions(sessions, scale); });
    json["scores"].push_back({{"score", stats::ssq_name(scale)},
                              {"label", label_of(scale)},
                              {"weight", stats::ssq_weight(scale)},
                              {"max", *stats::ssq_score(scale, worst)},
                              {"before", summary_json(change.before)},
                              {"after", summary_json(change.after)},
                              {"change", change_json(change)}});
  }
  return json;
}

std::vector<double> scores_of(const Sessions& sessions, const std::string& block) {
  std::vector<double> scores;
  for (const auto* session : sessions) {
    for (const FmsAnswer& answer : session->fms) {
      if (block.empty() || answer.block == block) scores.push_back(answer.score);
    }
  }
  return scores;
}

/// Statistics over people of each person's mean and largest FMS score. `block`: the block whose answers are
/// used; empty: all blocks.
Json course_json(const People& people, const std::string& block) {
  std::vector<double> means, peaks;
  for (const auto& [code, sessions] : people) {
    const auto summary = stats::describe(scores_of(sessions, block));
    if (!summary) continue;
    means.push_back(summary->mean);
    peaks.push_back(summary->max);
  }
  return {{"mean", summary_json(stats::describe(means))}, {"peak", summary_json(stats::describe(peaks))}};
}

/// Names of the blocks, sorted by the earliest position at which a session asked for the FMS in the block.
std::vector<std::string> blocks_of(const People& people) {
  std::map<std::string, int> first;
  for (const auto& [code, sessions] : people) {
    for (const auto* session : sessions) {
      for (const FmsAnswer& answer : session->fms) {
        const auto [at, fresh] = first.emplace(answer.block, answer.position);
        at->second = std::min(at->second, answer.position);
      }
    }
  }
  std::vector<std::string> blocks;
  for (const auto& [block, position] : first) blocks.push_back(block);
  std::sort(blocks.begin(), blocks.end(),
            [&](const auto& a, const auto& b) { return first.at(a) < first.at(b); });
  return blocks;
}

/// A list with one entry for each n: statistics of the n-th FMS answer over all sessions with at least n
/// answers.
Json times_json(const People& people) {
  Json list = Json::array();
  for (std::size_t asked = 0;; ++asked) {
    std::vector<double> scores, minutes;
    for (const auto& [code, sessions] : people) {
      for (const auto* session : sessions) {
        if (asked >= session->fms.size()) continue;
        scores.push_back(session->fms[asked].score);
        // The minutes of an observer model's session are the program's run time and are left out.
        if (!is_simulated(*session)) minutes.push_back(session->fms[asked].minutes);
      }
    }
    if (scores.empty()) return list;
    const auto when = stats::describe(minutes);
    Json line{{"asked", asked + 1}, {"minutes", when ? Json(when->median) : Json()}};
    line.update(summary_json(stats::describe(scores)));
    list.push_back(std::move(line));
  }
}

Json fms_json(const People& people, const stats::AnalysisPlan& plan) {
  std::size_t answers = 0;
  for (const auto& [code, sessions] : people) answers += scores_of(sessions, "").size();
  if (answers == 0) return {};
  Json json{{"answers", answers}};
  json.update(course_json(people, ""));
  const auto change = compare(people, 1, plan, fms_occasions);
  json["first"] = summary_json(change.before);
  json["last"] = summary_json(change.after);
  json["change"] = change_json(change);
  json["blocks"] = Json::array();
  for (const std::string& block : blocks_of(people)) {
    Json line{{"block", block}};
    line.update(course_json(people, block));
    json["blocks"].push_back(std::move(line));
  }
  json["times"] = times_json(people);
  return json;
}

/// One entry for each participant: SSQ scores before and after, and the mean and largest FMS score.
Json participants_json(const People& people) {
  Json list = Json::array();
  for (const auto& [code, sessions] : people) {
    Json line{{"participant", code}};
    for (const stats::SsqScale scale : stats::ssq_scales) {
      const Occasions sums = ssq_occasions(sessions, scale);
      const std::string name = std::string("ssq_") + stats::ssq_name(scale);
      line[name + "_before"] = json_number(stats::ssq_weight(scale) * sums.before.value());
      line[name + "_after"] = json_number(stats::ssq_weight(scale) * sums.after.value());
    }
    const auto fms = stats::describe(scores_of(sessions, ""));
    line["fms_mean"] = fms ? Json(fms->mean) : Json();
    line["fms_peak"] = fms ? Json(fms->max) : Json();
    list.push_back(std::move(line));
  }
  return list;
}

Json sickness_protocol_json(const Sessions& sessions, const stats::AnalysisPlan& plan) {
  const bool persons =
      std::any_of(sessions.begin(), sessions.end(), [](const auto* one) { return !is_simulated(*one); });
  People people;
  for (const auto* session : sessions) {
    if (!persons || !is_simulated(*session)) people[session->participant].push_back(session);
  }
  return {{"protocol", {{"name", sessions[0]->protocol_name}, {"sha256", sessions[0]->protocol_sha256}}},
          {"test_data", sessions[0]->test_data},
          {"simulated", persons ? 0 : people.size()},
          {"participants", people.size()},
          {"ssq", ssq_json(people, plan)},
          {"fms", fms_json(people, plan)},
          {"scores", participants_json(people)}};
}

}  // namespace

Json sickness_json(std::vector<SicknessSession> sessions, const stats::AnalysisPlan& plan) {
  const auto is_test = [](const SicknessSession& session) { return session.test_data; };
  if (!std::all_of(sessions.begin(), sessions.end(), is_test)) std::erase_if(sessions, is_test);
  Json list = Json::array();
  for (auto first = sessions.begin(); first != sessions.end();) {
    Sessions of_protocol;
    for (const std::string sha256 = first->protocol_sha256;
         first != sessions.end() && first->protocol_sha256 == sha256; ++first)
      of_protocol.push_back(&*first);
    list.push_back(sickness_protocol_json(of_protocol, plan));
  }
  return list;
}

}  // namespace study
