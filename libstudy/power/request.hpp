#pragma once
/// Input of a power calculation.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// The kind of power calculation that a protocol's trials allow.
enum class PowerKind { Task1, Task2, Pilot };
/// Name in JSON: "task1", "task2", "pilot".
const char* power_kind_name(PowerKind kind);
/// base::Error unless the protocol is a pilot, shows pairs that vary effects, or tests one of the plan's
/// hypotheses about methods: by pairs, or by the questions of Task 1.
PowerKind power_kind(const Protocol& protocol, const stats::AnalysisPlan& plan = {});

/// The answers that simulated people give in Task 1.
enum class AnswerScale {
  Likert,     ///< scores rounded to whole numbers and limited to the question's scale
  Continuous  ///< scores neither rounded nor limited; TestPoint::closed_form is exact for them
};

/// Task 1: share, from 0 to 1, of the variance of one person's answers that is due to the interaction of
/// person and method. This part is equal at every n_*.
struct PersonByMethod {
  double realism = 0, sickness = 0;
};

struct PowerRequest {
  Protocol protocol;
  std::string file;    ///< path of the protocol's file, as the user gave it
  std::vector<int> n;  ///< numbers of participants, ascending
  int studies = 2000;  ///< simulated studies for each number of participants and each world
  std::uint64_t seed = 1;
  PlanInForce plan;    ///< analysis plan, with margins and the pilot's level
  double power = 0.8;  ///< requested power, 0 to 1
  /// Worlds (assumed true effects) to simulate, each at most once. "effect": the effect below; "null": no
  /// effect; "margin": differences equal to the plan's margins (Task 2: as "null"); "paper": effects as in
  /// the paper.
  std::vector<std::string> worlds;

  /// True effect. Task 1: difference between two methods, in standard deviations of the paired differences.
  /// Task 2: probability that the better method is chosen, or if effects vary, that a level of effects is
  /// chosen over none.
  std::optional<double> effect;
  std::optional<double> difference;  ///< Task 1: true difference in points of realism, in place of `effect`
  AnswerScale answers = AnswerScale::Likert;
  double sd_realism = 1.3;  ///< SD of the difference between one person's answers to two methods, in points
  double sd_sickness = 0.65;
  PersonByMethod person_by_method;
  double interval_bias = 0;  ///< Task 2: log odds by which the second interval is favoured

  /// Pilot: simulated observer. Default: a and b of the paper's curve at score 4.0.
  PtpeObserverParameters observer{23.68, 0.02};
  std::string question = {};  ///< Pilot: id of the scale; empty: the first that the trials ask
  /// Pilot: score at which the curve is fitted; empty: the plan's, else the protocol's, else the middle of
  /// the scale.
  std::optional<double> level = {};
  /// Pilot: requested half widths of the intervals of a (frames/s) and b (s/frame).
  std::optional<double> precision_a, precision_b;
};

/// rated_question() is the scale on which a simulated pilot is rated, rated_level() the score at which its
/// curve is fitted. base::Error if the trials ask no scale or not the requested one, or if the score lies
/// outside the scale.
Question rated_question(const PowerRequest& request);
double rated_level(const PowerRequest& request);

/// Shares estimated by the mixed models of Task 1 in an earlier study. `results`: JSON file of `vip-stats
/// report` or `vip-stats task1`. base::Error if it lacks these models, if no participant judged one method at
/// two n_*, or if the answers do not vary.
PersonByMethod person_by_method_of(const std::filesystem::path& results);

/// Reads numbers of participants from "26", "10:60" (step 1) or "10:60:5" (step 5). base::Error for another
/// form or a number outside 2 to 2,000.
std::vector<int> parse_participants(const std::string& text);

}  // namespace study
