#include "libstudy/power/request.hpp"

#include <algorithm>
#include <cmath>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_choice.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr int least_n = 2, most_n = 2000;
constexpr std::size_t most_result_bytes = std::size_t{1} << 28;

[[noreturn]] void fail_participants(const std::string& text, const std::string& problem) {
  throw base::Error("--n " + text, problem, "write LOW:HIGH, LOW:HIGH:STEP or one number, such as --n 10:60");
}

int whole(const std::string& text, std::string_view part) {
  const auto value = base::parse_number<int>(part);
  if (!value) fail_participants(text, "\"" + std::string(part) + "\" is not a whole number");
  return *value;
}

bool has_question(const Protocol& protocol, const std::string& id) {
  const auto questions = all_questions(protocol);
  return std::any_of(questions.begin(), questions.end(),
                     [&](const auto& question) { return question.second->id == id; });
}

/// base::Error if the protocol neither varies effects nor tests one of the plan's hypotheses about methods,
/// because worlds exist for effects and for these hypotheses only.
void check_claims(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (!protocol.design.effects.empty()) return;
  const auto shown = hypotheses_of(protocol, plan);
  if (!shown.claims.empty()) return;
  std::string why;
  for (const auto& [id, reason, ids] : shown.left_out) why += (why.empty() ? "" : "; ") + id + ": " + reason;
  throw base::Error(
      "protocol " + protocol.name,
      "tests none of " + ids_in_short(ids_of(claims_in_force(plan))) +
          ", and power is computed for these alone (" + why + ")",
      "simulate it: vip-study run with --observer for several numbers of participants, then "
      "vip-stats report, which describes the answers of any protocol, or vip-stats study, which "
      "analyses designs with factors");
}

/// Share sd_method^2 / (sd_method^2 + sd_residual^2), from the mixed model of one score in the results.
double share_of_method(const std::filesystem::path& file, const Json& results, const std::string& score) {
  const auto refuse = [&](const std::string& problem) {
    throw base::Error(file.string(), problem, "give the share itself with --person-by-method, such as 0.3");
  };
  const Json models = results.value(Json::json_pointer("/task1/mixed"), Json::array());
  for (const auto& model : models) {
    if (!model.is_object() || model.value("score", Json()) != score) continue;
    if (model.contains("refused"))
      refuse("has no mixed model of " + score + ": " + model.at("refused").dump());
    const Json method = model.value("sd_method", Json()), residual = model.value("sd_residual", Json());
    if (!method.is_number() || !residual.is_number())
      refuse("has no variance of person by method of " + score + ": no participant judged one method twice");
    const double of_method = std::pow(method.get<double>(), 2), rest = std::pow(residual.get<double>(), 2);
    if (!(of_method + rest > 0)) refuse("has answers of " + score + " without any scatter");
    return of_method / (of_method + rest);
  }
  refuse("has no mixed model of " + score + " under task1.mixed");
  return 0;
}

}  // namespace

PersonByMethod person_by_method_of(const std::filesystem::path& file) {
  const Json results = base::parse_json(base::read_file(file, most_result_bytes));
  if (!results.is_object() || results.value("schema", Json()) != "vip-results/1") {
    throw base::Error(file.string(), "is not the JSON of a study's results",
                      "write it with vip-stats report STUDY.db --json " + file.filename().string());
  }
  return {share_of_method(file, results, "realism"), share_of_method(file, results, "sickness")};
}

const char* power_kind_name(PowerKind kind) {
  switch (kind) {
    case PowerKind::Task1:
      return "task1";
    case PowerKind::Task2:
      return "task2";
    case PowerKind::Pilot:
      break;
  }
  return "pilot";
}

PowerKind power_kind(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (!protocol.design.effects.empty() && !protocol.design.pairs) {
    throw base::Error("protocol " + protocol.name,
                      "varies effects of rated stimuli, and power can simulate effects only where pairs are "
                      "shown",
                      "simulate it: vip-study run with --observer ptpe:effects=... for several numbers of "
                      "participants, then vip-stats report");
  }
  if (protocol.design.pairs) {
    check_claims(protocol, plan);
    return PowerKind::Task2;
  }
  if (protocol.design.timing == TimingSource::Settings) return PowerKind::Pilot;
  for (const char* id : {"realism", "disorientation", "unrealism", "dizziness", "confusion"}) {
    if (!has_question(protocol, id)) {
      throw base::Error("protocol " + protocol.name, "does not ask \"" + std::string(id) + "\"",
                        "use a pilot (mean_fps and sd_fps), Task 1 (realism and the four items of "
                        "cybersickness) or Task 2 (pairs)");
    }
  }
  check_claims(protocol, plan);
  return PowerKind::Task1;
}

Question rated_question(const PowerRequest& request) {
  const auto questions = curve_questions(request.protocol);
  if (questions.empty()) {
    throw base::Error("protocol " + request.protocol.name, "asks no question on a scale in its trials",
                      "add a question of kind \"scale\" to its block of kind \"stimulus\"");
  }
  std::vector<std::string> ids;
  for (const auto& one : questions) {
    if (request.question.empty() || one.id == request.question) return one;
    ids.push_back(one.id);
  }
  throw base::Error("--question " + request.question,
                    "is no scale that the trials of " + request.protocol.name + " ask",
                    base::use_one_of(request.question, ids));
}

double rated_level(const PowerRequest& request) {
  const auto question = rated_question(request);
  const double level = level_of({TaskKind::Pilot, {}, request.plan.plan, {}, request.level}, question);
  if (within_scale(level, question)) return level;
  throw base::Error("protocol " + request.protocol.name, outside_scale(level, question),
                    mend_of_level(question));
}

std::vector<int> parse_participants(const std::string& text) {
  std::vector<std::string_view> parts;
  for (std::string_view rest = text;;) {
    const auto colon = rest.find(':');
    parts.push_back(rest.substr(0, colon));
    if (colon == std::string_view::npos) break;
    rest.remove_prefix(colon + 1);
  }
  if (parts.size() > 3) fail_participants(text, "has too many parts");
  const int low = whole(text, parts[0]);
  const int high = parts.size() > 1 ? whole(text, parts[1]) : low;
  const int step = parts.size() > 2 ? whole(text, parts[2]) : 1;
  if (low < least_n || high > most_n) fail_participants(text, "numbers of participants go from 2 to 2000");
  if (high < low) fail_participants(text, "ends below its start");
  if (step < 1) fail_participants(text, "needs a step of 1 or more");
  std::vector<int> out;
  for (int n = low; n <= high; n += step) out.push_back(n);
  return out;
}

}  // namespace study
