#pragma once
/// The analysis plan as a file, which preregistration writes and `--plan` reads.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/plan.hpp"

namespace study {

/// A plan and its source.
struct PlanInForce {
  stats::AnalysisPlan plan;
  std::string source = "defaults";     ///< name of the plan's file; "defaults" without a file
  std::string sha256;                  ///< SHA-256 of the plan's file; empty without a file
  std::vector<std::string> protocols;  ///< SHA-256 of each protocol for which the plan was preregistered
};

/// Reads a plan from a TOML file. Only `format` is required; a missing key has its default. A preregistered
/// file (one with the key `protocols`) has older defaults: `decision` is "holm", only the hypotheses with
/// once_one_sided are tested one-sided (key `directional`), `more_than_one_trial` is "refuse". base::Error at
/// file:line:column for an unknown key, a wrong type or a value out of range. `protocol`: the tables
/// [[hypothesis]] and [model_comparison] must name its factors, levels and questions; null: these names are
/// not checked.
PlanInForce read_plan(const std::filesystem::path& file, const Protocol* protocol = nullptr);

/// A timing rule says from which verdict on the timing of its showing on a trial is excluded.
/// timing_rule_name() returns its name: "none" (no verdict excludes), "fail" or "degraded". timing_rule_of()
/// returns the rule of a name, and throws base::Error for any other name.
const char* timing_rule_name(stats::TimingRule rule);
stats::TimingRule timing_rule_of(const std::string& name);

/// Text of a plan file. read_plan() reads the same plan from it. The tables [pilot], [levels],
/// [model_comparison] and [[hypothesis]] are written only if they differ from the defaults, all other keys
/// always.
std::string format_plan(const stats::AnalysisPlan& plan, const std::vector<std::string>& protocols);

/// The entry "plan" of the results. `protocols`: SHA-256 of the study's protocols.
Json plan_json(const PlanInForce& plan, const std::vector<std::string>& protocols);

/// Facts about a preregistration (bundle) that the results of a study need.
struct FrozenFacts {
  std::string sha256, frozen_utc;      ///< the bundle's hash and date
  std::vector<std::string> altered;    ///< files that differ from the bundle's manifest
  std::vector<std::string> protocols;  ///< SHA-256 of the protocols in the bundle
};

/// The entry "preregistration" of results. Its member "preregistered" is true if the bundle is intact, holds
/// the protocol and was frozen before the first answer, and if no session's clock is in doubt. "problems"
/// lists the reasons against it.
Json preregistration_json(const FrozenFacts& frozen, const TaskData& data);

}  // namespace study
