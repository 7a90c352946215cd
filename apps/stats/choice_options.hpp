#pragma once
/// Options and help that several commands share: the protocols and questions to analyse, and the level
/// (score) at which a curve is fitted to the ratings of a pilot study.

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/task_choice.hpp"

namespace apps {

/// The end of the help of commands whose files a withdrawal deletes.
inline constexpr const char* registered_files =
    "Files hold values of single participants, so only their owner may read them (0600), and they are\n"
    "registered in the database, which must be writable for that: when one of them withdraws, the files are\n"
    "deleted, to be made again.";

struct ChoiceOptions {
  std::string protocol;  ///< name with or without version, or first digits of the SHA-256; empty: all
  std::string question;  ///< id of the question; empty: all questions
  /// Score at which a pilot's curve is fitted; empty: the plan's, else the protocol's, else the scale's
  /// middle.
  std::optional<double> level;

  study::TaskSelection selection(study::TaskKind task, const stats::AnalysisPlan& plan) const {
    return {task, protocol, plan, question, level};
  }
};

/// Adds --protocol.
CLI::Option* add_protocol_choice(CLI::App& command, ChoiceOptions& options);
/// Adds --level SCORE.
CLI::Option* add_level_choice(CLI::App& command, ChoiceOptions& options);
/// Adds --protocol, --question and --level.
void add_choice(CLI::App& command, ChoiceOptions& options);

/// Facts about the preregistration in the folder. base::Error if the folder is no bundle.
study::FrozenFacts frozen_facts(const std::string& folder);

}  // namespace apps
