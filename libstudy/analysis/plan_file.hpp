#pragma once
/// The analysis plan as a file, which preregistration writes and `--plan` reads.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/analysis/plan.hpp"

namespace study {

/// A plan and its source.
struct PlanInForce {
  stats::AnalysisPlan plan;
  std::string source = "defaults";     ///< or the file's name
  std::string sha256;                  ///< of the file; empty: no file
  std::vector<std::string> protocols;  ///< SHA-256 of the protocols that it was preregistered for
};

/// Reads TOML. Every key is optional and has its default, with one exception: a file that names protocols and
/// lacks `decision` or `directional` was frozen before these keys existed, and follows the rules of that time
/// (Holm). base::Error at file:line:column for an unknown key, a wrong type or a value out of range.
PlanInForce read_plan(const std::filesystem::path& file);

/// Converts to "none", "fail" or "degraded" and back; base::Error for another name.
const char* timing_rule_name(stats::TimingRule rule);
stats::TimingRule timing_rule_of(const std::string& name);

/// Text of a plan file that read_plan() reads back as the same plan; every key is written out.
std::string format_plan(const stats::AnalysisPlan& plan, const std::vector<std::string>& protocols);

/// "plan" of the results; `protocols`: SHA-256 of the study's protocols.
Json plan_json(const PlanInForce& plan, const std::vector<std::string>& protocols);

}  // namespace study
