#pragma once
/// The analysis plan as a file: what preregistration freezes and `--plan` reads.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "stats/analysis/plan.hpp"

namespace apps {

/// A plan and where it comes from.
struct PlanInForce {
  stats::AnalysisPlan plan;
  std::string source = "defaults";     ///< or the file
  std::string sha256;                  ///< of the file; empty: none
  std::vector<std::string> protocols;  ///< SHA-256 of the protocols that it was preregistered for
};

/// TOML; every key may be left out and then has its default, but in a file that names protocols `decision`
/// and `directional`: it was frozen before they were there, under Holm. base::Error at file:line:column for
/// an unknown key, a wrong type or a value out of range.
PlanInForce read_plan(const std::filesystem::path& file);

/// "none", "fail" or "degraded", and back; base::Error for another name.
const char* timing_rule_name(stats::TimingRule rule);
stats::TimingRule timing_rule_of(const std::string& name);

/// The file that read_plan() reads back as the same plan, every key written out.
std::string format_plan(const stats::AnalysisPlan& plan, const std::vector<std::string>& protocols);

/// "plan" of the results; `protocols`: of the study.
Json plan_json(const PlanInForce& plan, const std::vector<std::string>& protocols);

}  // namespace apps
