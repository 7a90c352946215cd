#pragma once
/// The input of a power calculation.

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
/// "task1", "task2", "pilot".
const char* power_kind_name(PowerKind kind);
/// base::Error if the protocol shows neither settings, nor pairs of methods, nor rated methods.
PowerKind power_kind(const Protocol& protocol);

/// How simulated people answer Task 1.
enum class AnswerScale {
  Likert,     ///< whole scores within the question's scale
  Continuous  ///< unrounded and unbounded, for which the closed forms hold exactly
};

/// Task 1: the share of an answer's variance, excluding the person's own level, that belongs to person by
/// method and so is the same at every n_*; 0 to 1.
struct PersonByMethod {
  double realism = 0, sickness = 0;
};

struct PowerRequest {
  Protocol protocol;
  std::string file;    ///< the protocol's file, as given
  std::vector<int> n;  ///< participants, ascending
  int studies = 2000;  ///< simulated for each number of participants and world
  std::uint64_t seed = 1;
  PlanInForce plan;                 ///< margins, level
  double power = 0.8;               ///< requested power
  std::vector<std::string> worlds;  ///< "effect", "null", "margin", "paper"; each at most once

  /// Task 1: difference in standard deviations of the paired differences; Task 2: true preference of the
  /// better method.
  std::optional<double> effect;
  std::optional<double> difference;  ///< Task 1: the same in points of realism
  AnswerScale answers = AnswerScale::Likert;
  double sd_realism = 1.3;  ///< of the difference between two methods' answers of one person, points
  double sd_sickness = 0.65;
  PersonByMethod person_by_method;
  double interval_bias = 0;  ///< Task 2: log odds in favour of the second interval

  PtpeObserverParameters observer{23.68, 0.02};  ///< Pilot: the paper's PTPE@4.0
  std::string question = {};         ///< Pilot: id of the scale; empty: the first that the trials ask
  std::optional<double> level = {};  ///< Pilot: score of the observer's curve; empty: see level_of()
  std::optional<double> precision_a, precision_b;  ///< requested half widths: frames/s, s/frame
};

/// The scale that a simulated pilot is rated on, and the level at which its curve is fitted. base::Error if
/// the trials ask no scale, or not the requested one, or if the level lies outside it.
Question rated_question(const PowerRequest& request);
double rated_level(const PowerRequest& request);

/// The shares estimated by the mixed models of Task 1 in an earlier study: `results` is the JSON of vip-stats
/// report or task1. base::Error if it holds no such model, or if no participant judged one method at two n_*.
PersonByMethod person_by_method_of(const std::filesystem::path& results);

/// "10:60", "10:60:5" or "26" as numbers of participants, from 2 to 2,000. base::Error otherwise.
std::vector<int> parse_participants(const std::string& text);

}  // namespace study
