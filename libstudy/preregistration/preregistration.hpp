#pragma once
/// Writes and reads preregistrations. A preregistration is a folder (bundle) with protocols, hypotheses and
/// rules, identified by one SHA-256 and written before data are collected.

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

/// Writes the folder `out` with these files: a copy of each protocol; hypotheses.json (the hypotheses about
/// methods that the protocols test, each with its margin); plan.toml (margins, levels, exclusion rules,
/// seed); power.json if requested; about.json; PREREGISTRATION.txt for people; MANIFEST.sha256 for `sha256sum
/// -c`. Returns the bundle's hash, which is the SHA-256 of MANIFEST.sha256. base::Error, and `out` does
/// not change, if `out` exists and is not an empty folder, if a protocol cannot be read, if two have the same
/// name or different levels for one question, if `power` cannot be read or is no JSON, or if the folder
/// cannot be written.
std::string freeze_bundle(const BundleRequest& request, const std::filesystem::path& out);

/// The hypotheses about methods that the requested protocols do not test, each with the reason: "ID of task1:
/// the protocol does not show FovFluid". If another protocol tests the hypothesis, it is listed only for a
/// protocol that tests no hypothesis at all.
std::vector<std::string> untested_claims(const BundleRequest& request);

/// A bundle as read from disk.
struct Bundle {
  std::string sha256;                ///< SHA-256 of MANIFEST.sha256: the bundle's hash
  std::vector<std::string> altered;  ///< files that are missing or whose SHA-256 differs from the manifest
  base::Json about, hypotheses;
  std::map<std::string, std::string> protocols;  ///< text of each protocol by its SHA-256
  PlanInForce plan;
};

/// Reads a bundle and checks its files against the manifest. base::Error if the folder is no bundle.
Bundle read_bundle(const std::filesystem::path& folder);

/// The entry "preregistration" of the results (docs/report.md): for each task, true if its protocol and
/// hypotheses are those of the bundle, the bundle is older than the first answer or no answer has a time, and
/// no file of the bundle was altered; and all differences. `protocols`: the database's protocols. `results`:
/// from study_results() with the bundle's plan.
base::Json compare_with_bundle(const Bundle& bundle, const std::vector<ProtocolRow>& protocols,
                               const base::Json& results);

}  // namespace study::report
