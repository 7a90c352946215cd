#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/analysis/tasks/hypotheses_json.hpp"
#include "libstudy/preregistration/bundle_parts.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/new_file.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

namespace fs = std::filesystem;
using Json = base::Json;
using Files = std::map<std::string, std::string>;  ///< content of each file by its name

std::vector<Protocol> read_protocols(const std::vector<fs::path>& paths) {
  std::vector<Protocol> out;
  for (const auto& path : paths) {
    out.push_back(read_protocol(find_protocol(path)));
    for (std::size_t i = 0; i + 1 < out.size(); ++i) {
      if (out[i].name == out.back().name)
        throw base::Error(path.string(), "has the same name as another protocol, " + out[i].name,
                          "give each protocol of a bundle a different name");
    }
  }
  return out;
}

/// For each protocol, the hypotheses that it does not test, with the reason: "ID of task1: ...". A hypothesis
/// is omitted if another protocol tests it, unless this protocol tests none at all.
std::vector<std::string> untested_of(const std::vector<Protocol>& protocols,
                                     const stats::AnalysisPlan& plan) {
  // The shipped hypotheses compare methods. They do not concern a plan that declares hypotheses about
  // factors.
  if (plan.claims.empty() && !plan.hypotheses.empty()) return {};
  std::vector<stats::ShownClaims> shown;
  std::set<std::string> tested;
  for (const auto& protocol : protocols) {
    shown.push_back(hypotheses_of(protocol, plan));
    for (const auto& claim : shown.back().claims) tested.insert(claim.id);
  }
  std::vector<std::string> out;
  for (std::size_t i = 0; i < protocols.size(); ++i) {
    for (const auto& [id, reason, ids] : shown[i].left_out)
      if (shown[i].claims.empty() ||
          !std::all_of(ids.begin(), ids.end(), [&](const auto& one) { return tested.contains(one); }))
        out.push_back(id + " of " + protocols[i].name + ": " + reason);
  }
  return out;
}

/// The plan with a level (the score at which a pilot's curve is fitted) for each question with a curve. A
/// level that the plan lacks is taken from the protocol. base::Error if two protocols have different levels
/// for one question.
stats::AnalysisPlan with_levels(stats::AnalysisPlan plan, const std::vector<Protocol>& protocols) {
  const auto given = plan.levels;
  std::map<std::string, std::string> named_by;
  for (const auto& protocol : protocols) {
    for (const auto& question : curve_questions(protocol)) {
      if (given.contains(question.id)) continue;
      const double level = fitted_level(question);
      const auto [found, added] = plan.levels.emplace(question.id, level);
      const auto other = named_by.emplace(question.id, protocol.name).first;
      if (added || other->second == protocol.name || found->second == level) continue;
      throw base::Error(protocol.place,
                        "asks \"" + question.id + "\" with the level " + base::shortest(level) +
                            ", protocol " + other->second + " with the level " +
                            base::shortest(found->second),
                        "give the two questions ids of their own, or the same level");
    }
  }
  return plan;
}

Files contents(const BundleRequest& request) {
  const auto protocols = read_protocols(request.protocols);
  const std::string now = base::utc_now();
  Files files;
  Json hypotheses = Json::array(), listed = Json::array();
  for (const auto& protocol : protocols) {
    const std::string name = "protocol_" + protocol.sha256.substr(0, 12) + ".toml";
    files[name] = protocol.text;
    listed.push_back({{"name", protocol.name},
                      {"version", protocol.version},
                      {"sha256", protocol.sha256},
                      {"file", name}});
    for (const auto& hypothesis : hypotheses_of(protocol, request.plan).claims)
      hypotheses.push_back(fixed_part(hypothesis_json(hypothesis)));
  }
  const auto plan = with_levels(request.plan, protocols);
  files["hypotheses.json"] = hypotheses.dump(2) + "\n";
  files["plan.toml"] = frozen_plan(protocols, plan);
  if (request.power) {
    files["power.json"] = base::read_file(*request.power, largest_bundle_file);
    if (base::parse_json(files["power.json"]).is_null())
      throw base::Error(request.power->string(), "is no JSON",
                        "give the file that vip-stats power --json wrote");
  }
  files["about.json"] = Json{{"schema", "vip-preregistration/1"},
                             {"frozen_utc", now},
                             {"vip_lab", base::version()},
                             {"seed", request.plan.seed},
                             {"protocols", listed}}
                            .dump(2) +
                        "\n";
  files["PREREGISTRATION.txt"] =
      bundle_text(protocols, plan, hypotheses, untested_of(protocols, plan), request.power.has_value(), now);
  return files;
}

/// A new folder with a temporary name. keep() renames it to its final name; without keep() the destructor
/// deletes it.
class Draft {
 public:
  explicit Draft(const fs::path& out) : out_(out), path_(base::draft_name(out)) {
    std::error_code failed;
    if (out.has_parent_path()) fs::create_directories(out.parent_path(), failed);
    // create_directory() returns false if a folder or link of this name exists. This is an error, so that
    // files are written only into a new folder.
    if (failed || !fs::create_directory(path_, failed))
      throw base::Error(out.string(),
                        "its temporary folder " + path_.string() +
                            (failed ? " cannot be created: " + failed.message() : " exists already"),
                        "choose another folder, in which you may create files");
  }
  ~Draft() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const fs::path& path() const { return path_; }
  void keep() {
    base::sync_folders(path_);
    if (!base::rename_durably(path_, out_))
      throw base::Error(out_.string(), std::string("cannot be created: ") + std::strerror(errno),
                        "choose a folder that does not exist yet");
  }

 private:
  fs::path out_, path_;
};

}  // namespace

std::vector<std::string> untested_claims(const BundleRequest& request) {
  return untested_of(read_protocols(request.protocols), request.plan);
}

std::string freeze_bundle(const BundleRequest& request, const fs::path& given) {
  const fs::path out = given.has_filename() ? given : given.parent_path();
  if (fs::exists(out) && (!fs::is_directory(out) || !fs::is_empty(out)))
    throw base::Error(out.string(), "exists already, and a bundle is never overwritten",
                      "choose a new folder");
  const Files files = contents(request);
  std::string manifest;
  for (const auto& [name, bytes] : files) manifest += base::sha256_hex(bytes) + "  " + name + "\n";
  Draft draft(out);
  for (const auto& [name, bytes] : files) base::write_file_atomically(draft.path() / name, bytes);
  base::write_file_atomically(draft.path() / "MANIFEST.sha256", manifest);
  draft.keep();
  return base::sha256_hex(manifest);
}

}  // namespace study::report
