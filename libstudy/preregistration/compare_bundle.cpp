#include <algorithm>
#include <sstream>

#include "libstudy/preregistration/bundle_parts.hpp"
#include "libstudy/preregistration/line_difference.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::report {

namespace {

namespace fs = std::filesystem;
using Json = base::Json;

/// Largest number of differing lines of a protocol that are quoted from each version.
constexpr std::size_t most_lines = 12;

[[noreturn]] void no_bundle(const fs::path& folder, const std::string& problem) {
  throw base::Error(folder.string(), problem, "give a folder that vip-stats preregister wrote");
}

/// SHA-256 of each file by its name, from the text of MANIFEST.sha256. `folder`: named in errors.
std::map<std::string, std::string> read_manifest(const std::string& text, const fs::path& folder) {
  std::map<std::string, std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string name = line.size() > 66 ? line.substr(66) : "";
    if (name.empty() || line.substr(64, 2) != "  " || name.find('/') != std::string::npos)
      no_bundle(folder, "MANIFEST.sha256 cannot be read: \"" + line + "\"");
    out[name] = line.substr(0, 64);
  }
  return out;
}

/// Deepest nesting that is accepted in a bundle's JSON. To compare or print much deeper JSON would overflow
/// the stack.
constexpr int most_levels = 16;

Json parsed(const std::string& bytes, const fs::path& file) {
  if (base::nested_deeper_than(most_levels, bytes))
    no_bundle(file, "is nested more than " + std::to_string(most_levels) + " levels deep");
  try {
    return Json::parse(bytes);
  } catch (const base::JsonError&) {
    no_bundle(file, "is no JSON");
  }
}

bool has_texts(const Json& object, std::initializer_list<const char*> keys) {
  return object.is_object() && std::all_of(keys.begin(), keys.end(), [&](const char* key) {
           return object.contains(key) && object[key].is_string();
         });
}

/// base::Error unless about.json has the fields that the comparison reads, as texts.
void check_about(const Json& about, const fs::path& file) {
  if (!has_texts(about, {"schema"}) || about["schema"] != "vip-preregistration/1")
    no_bundle(file, "is not of schema vip-preregistration/1");
  const Json protocols = about.value("protocols", Json());
  const bool listed =
      protocols.is_array() && std::all_of(protocols.begin(), protocols.end(), [](const Json& one) {
        return has_texts(one, {"name", "sha256"});
      });
  if (!listed || !has_texts(about, {"frozen_utc", "vip_lab"}))
    no_bundle(file, "does not name its protocols, date and version");
}

void check_hypotheses(const Json& hypotheses, const fs::path& file) {
  if (!hypotheses.is_array()) no_bundle(file, "is not a list of hypotheses");
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Json& one = hypotheses[i];
    bool whole = has_texts(one, {"id", "task"}) && one.contains("tests") && one["tests"].is_array();
    if (whole)
      for (const Json& test : one["tests"]) whole = whole && has_texts(test, {"label"});
    if (!whole) no_bundle(file, "entry " + std::to_string(i + 1) + " is no hypothesis");
  }
}

void quote(Json& differences, const std::string& what, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < std::min(lines.size(), most_lines); ++i)
    differences.push_back(what + ": " + lines[i]);
  if (lines.size() > most_lines)
    differences.push_back(what + ": " + std::to_string(lines.size() - most_lines) + " further lines");
}

std::string name_in_bundle(const Json& about, const std::string& sha256) {
  for (const Json& protocol : about.value("protocols", Json::array()))
    if (protocol.value("sha256", "") == sha256) return protocol.value("name", "");
  return "";
}

/// True if the study's protocol is in the bundle. Otherwise adds to `differences` how it differs from the
/// bundle's protocol of the same name, or that the bundle has no protocol of this name (except for a pilot).
bool same_protocol(const Bundle& bundle, const ProtocolRow& used, bool pilot, Json& differences) {
  if (bundle.protocols.contains(used.sha256)) return true;
  const auto planned = std::find_if(bundle.protocols.begin(), bundle.protocols.end(), [&](const auto& entry) {
    return name_in_bundle(bundle.about, entry.first) == used.name;
  });
  if (planned == bundle.protocols.end()) {
    // A bundle of Task 1 or 2 need not hold the pilot; without it, the pilot is exploratory.
    if (pilot) return false;
    differences.push_back("protocol " + used.name + " was not preregistered");
    return false;
  }
  differences.push_back("protocol " + used.name + " has the hash " + used.sha256.substr(0, 12) +
                        ", preregistered was " + planned->first.substr(0, 12));
  if (used.trial_seconds)
    differences.push_back("protocol " + used.name + ": trials were shortened for a test");
  const auto lines = line_difference(planned->second, used.text);
  quote(differences, "protocol " + used.name + ", preregistered only", lines.only_first);
  quote(differences, "protocol " + used.name + ", used only", lines.only_second);
  return false;
}

/// Compares the keys of `tested` with those of `planned`. Adds each difference to `differences`, such as
/// "NAME, margin: preregistered 0.5, tested 0.4". Returns false if there is a difference.
bool same_part(const std::string& name, const Json& planned, const Json& tested, Json& differences) {
  bool same = true;
  for (const auto& [key, value] : tested.items()) {
    const Json before = planned.value(key, Json());
    if (before == value) continue;
    differences.push_back(name + ", " + key + ": preregistered " + before.dump() + ", tested " +
                          value.dump());
    same = false;
  }
  return same;
}

/// Compares two results of fixed_part() for one hypothesis, test by test. Adds each difference to
/// `differences`. Returns false if there is a difference.
bool same_hypothesis(Json planned, Json tested, Json& differences) {
  const std::string id = tested.at("id");
  std::map<std::string, Json> before;
  for (const Json& test : planned.at("tests")) before[test.at("label").text()] = test;
  bool same = true;
  for (const Json& test : tested.at("tests")) {
    const std::string label = test.at("label"), name = id + ", " + label;
    if (!before.contains(label)) {
      differences.push_back(name + " was not preregistered");
      same = false;
    } else if (!same_part(name, before[label], test, differences)) {
      same = false;
    }
    before.erase(label);
  }
  for (const auto& [label, test] : before) {
    differences.push_back(id + ", " + label + " was preregistered and is not tested here");
    same = false;
  }
  planned.erase("tests");
  tested.erase("tests");
  return same_part(id, planned, tested, differences) && same;
}

/// True if the hypotheses of a task were tested as the bundle plans. Adds each difference to `differences`.
bool same_hypotheses(const Bundle& bundle, const std::string& task, const Json& results, Json& differences) {
  bool same = true;
  std::map<std::string, Json> planned;
  for (const Json& hypothesis : bundle.hypotheses)
    if (hypothesis.at("task") == task) planned[hypothesis.at("id").text()] = hypothesis;
  for (const Json& hypothesis : results.value("hypotheses", Json::array())) {
    if (hypothesis.at("task") != task) continue;
    const std::string id = hypothesis.at("id");
    const Json now = fixed_part(hypothesis);
    const auto before = planned.find(id);
    if (before == planned.end()) {
      differences.push_back(id + " was not preregistered");
      same = false;
      continue;
    }
    same = same_hypothesis(before->second, now, differences) && same;
    planned.erase(before);
  }
  for (const auto& [id, hypothesis] : planned) {
    differences.push_back(id + " was preregistered and is not tested here");
    same = false;
  }
  return same;
}

/// True if the pilot's curve was fitted at the level (score) that the bundle's plan names for its question,
/// or if the plan names none. Otherwise adds the two levels to `differences`.
bool same_level(const Bundle& bundle, const Json& results, Json& differences) {
  const Json pilot = results.value("pilot", Json());
  if (!pilot.is_object() || !pilot.contains("question") || !pilot.at("level").is_number()) return true;
  const std::string question = pilot.at("question");
  const auto planned = bundle.plan.plan.levels.find(question);
  if (planned == bundle.plan.plan.levels.end() || planned->second == pilot.at("level").get<double>())
    return true;
  differences.push_back("the curve of question " + question + ": preregistered at level " +
                        Json(planned->second).dump() + ", fitted at " + pilot.at("level").dump());
  return false;
}

}  // namespace

Bundle read_bundle(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "MANIFEST.sha256")) no_bundle(folder, "holds no MANIFEST.sha256");
  const std::string manifest = base::read_file(folder / "MANIFEST.sha256", largest_bundle_file);
  Bundle bundle;
  bundle.sha256 = base::sha256_hex(manifest);
  std::map<std::string, std::string> files;
  for (const auto& [name, hash] : read_manifest(manifest, folder)) {
    std::error_code no_such_name;
    if (fs::is_regular_file(folder / name, no_such_name))
      files[name] = base::read_file(folder / name, largest_bundle_file);
    if (!files.contains(name) || base::sha256_hex(files[name]) != hash) bundle.altered.push_back(name);
  }
  for (const char* needed : {"about.json", "hypotheses.json", "plan.toml"})
    if (!files.contains(needed)) no_bundle(folder, std::string("holds no ") + needed);
  bundle.about = parsed(files["about.json"], folder / "about.json");
  check_about(bundle.about, folder / "about.json");
  bundle.hypotheses = parsed(files["hypotheses.json"], folder / "hypotheses.json");
  check_hypotheses(bundle.hypotheses, folder / "hypotheses.json");
  for (const auto& [name, bytes] : files)
    if (name.starts_with("protocol_")) bundle.protocols[base::sha256_hex(bytes)] = bytes;
  bundle.plan = read_plan(folder / "plan.toml");
  return bundle;
}

Json compare_with_bundle(const Bundle& bundle, const std::vector<ProtocolRow>& protocols,
                         const Json& results) {
  Json differences = Json::array(), tasks = Json::object(), times = Json::array();
  const std::string frozen = bundle.about.value("frozen_utc", "");
  std::size_t unknowns = 0;
  for (const auto& name : bundle.altered)
    differences.push_back(name + " was changed or removed after the bundle was frozen");
  for (const Json& used : results.at("study").value("protocols", Json::array())) {
    const std::string task = used.at("task"), sha256 = used.at("sha256");
    const auto row = std::find_if(protocols.begin(), protocols.end(),
                                  [&](const auto& protocol) { return protocol.sha256 == sha256; });
    const bool protocol_holds =
        row != protocols.end() && same_protocol(bundle, *row, task == "pilot", differences);
    const bool hypotheses_hold = same_hypotheses(bundle, task, results, differences) &&
                                 (task != "pilot" || same_level(bundle, results, differences));
    const Json time = time_json(frozen, used);
    const bool late = time.at("frozen_before") == false;
    const bool unknown = time.at("frozen_before").is_null() && time.at("clocks_disagree") == true;
    const bool covered = protocol_holds || task != "pilot";
    if (covered) times.push_back(time);
    if (covered && (late || unknown)) differences.push_back(time.at("text"));
    if (covered && unknown) ++unknowns;
    tasks[task] = protocol_holds && hypotheses_hold && bundle.altered.empty() && !late && !unknown;
  }
  const bool holds = differences.empty();
  return {{"sha256", bundle.sha256},
          {"frozen_utc", frozen},
          {"vip_lab", bundle.about.value("vip_lab", "")},
          {"holds", holds},
          {"summary",
           holds ? "Protocols, hypotheses, margins and rules are those of the bundle, which is older than "
                   "the answers."
           : unknowns == differences.size()
               ? "Protocols, hypotheses, margins and rules are those of the bundle; whether it is older than "
                 "the answers cannot be told, as clocks disagree."
               : "The study or its analysis differs from the bundle."},
          {"tasks", tasks},
          {"times", times},
          {"differences", differences}};
}

}  // namespace study::report
