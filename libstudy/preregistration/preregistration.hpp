#pragma once
/// Preregistration: a folder (bundle) with protocols, hypotheses and rules under one SHA-256, fixed before
/// the data.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/base/json.hpp"

namespace study::report {

struct BundleRequest {
  std::vector<std::filesystem::path> protocols;
  stats::AnalysisPlan plan;
  std::optional<std::filesystem::path> power;  ///< JSON of `vip-stats power`
};

/// Writes the folder `out`: a copy of each protocol, hypotheses.json (H1 to H6 as far as the protocols test
/// them, each test with its margin), plan.toml (margins, level, exclusion rules, seed), power.json if given,
/// about.json, the readable PREREGISTRATION.txt, and MANIFEST.sha256 for sha256sum -c. Returns the bundle's
/// hash: the SHA-256 of MANIFEST.sha256. base::Error if `out` is not empty, a protocol cannot be read or two
/// have the same name; nothing is then left behind.
std::string freeze_bundle(const BundleRequest& request, const std::filesystem::path& out);

/// Hypotheses of the built-in analyses that these protocols do not test, each with the reason: "H1 of task1:
/// the protocol does not show FovFluid".
std::vector<std::string> untested_claims(const BundleRequest& request);

/// A bundle as it is on disk now.
struct Bundle {
  std::string sha256;                ///< of the manifest
  std::vector<std::string> altered;  ///< files that are missing or do not have the manifest's hash
  base::Json about, hypotheses;
  std::map<std::string, std::string> protocols;  ///< text by SHA-256 of the protocol
  PlanInForce plan;
};

/// base::Error if the folder is not a bundle.
Bundle read_bundle(const std::filesystem::path& folder);

/// "preregistration" of the results (docs/report.md): tells if each task's protocol and hypotheses are those
/// of the bundle, and lists differences. `results`: from study_results() under the bundle's plan.
base::Json compare_with_bundle(const Bundle& bundle, const std::vector<ProtocolRow>& protocols,
                               const base::Json& results);

}  // namespace study::report
