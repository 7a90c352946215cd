#pragma once
/// Which protocols and questions a command analyses, and at which level: the same options everywhere.

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

#include "apps/stats/data/task_choice.hpp"

namespace apps {

struct ChoiceOptions {
  std::string protocol;         ///< leading digits of the SHA-256; empty: all
  std::string question;         ///< its id; empty: all
  std::optional<double> level;  ///< none: that of level_of()

  TaskSelection selection(TaskKind task, const stats::AnalysisPlan& plan) const {
    return {task, protocol, plan, question, level};
  }
};

/// --protocol DIGITS.
CLI::Option* add_protocol_choice(CLI::App& command, ChoiceOptions& options);
/// --level SCORE.
CLI::Option* add_level_choice(CLI::App& command, ChoiceOptions& options);
/// All three.
void add_choice(CLI::App& command, ChoiceOptions& options);

}  // namespace apps
