#include "apps/stats/power_text.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace apps {

namespace {

/// Largest number of columns that are printed, one per number of participants; output files contain all.
constexpr std::size_t printed_columns = 6;

std::vector<std::size_t> columns_to_print(const study::Json& json) {
  const std::size_t count = json.at("settings").at("n").size();
  std::vector<std::size_t> out;
  const std::size_t columns = std::min(count, printed_columns);
  for (std::size_t i = 0; i < columns; ++i) out.push_back(columns == 1 ? 0 : i * (count - 1) / (columns - 1));
  return out;
}

std::string cell(const study::Json& point, const std::string& figure, int decimals = 3) {
  if (!point.contains(figure) || !point.at(figure).is_number()) return "-";
  return fmt::format("{0:.{2}f} ({1:.{2}f})", point.at(figure).get<double>(),
                     point.at(figure + "_se").get<double>(), decimals);
}

void print_row(const std::string& name, const study::Json& curve, const std::string& figure,
               const std::vector<std::size_t>& columns, int decimals = 3) {
  std::printf("  %-34s", name.c_str());
  for (const std::size_t i : columns) std::printf(" %13s", cell(curve[i], figure, decimals).c_str());
  std::printf("\n");
}

void print_head(const study::Json& json, const std::vector<std::size_t>& columns) {
  std::printf("  %-34s", "participants");
  for (const std::size_t i : columns) std::printf(" %13d", json.at("settings").at("n").at(i).get<int>());
  std::printf("\n");
}

void print_hypothesis(const study::Json& hypothesis, const study::Json& settings,
                      const std::vector<std::size_t>& columns) {
  const std::string id = hypothesis.at("id").get<std::string>();
  const auto tests = hypothesis.at("tests").size(), claims = hypothesis.at("claims_true").get<std::size_t>();
  const study::Json& curve = hypothesis.at("curve");
  const char* const verdict = claims == tests ? " supported (true: power)"
                              : claims > 0    ? " supported (only partly true)"
                                              : " supported (false: error)";
  print_row(id + verdict, curve, "supported", columns);
  if (tests > 1) print_row("  at least one test holds", curve, "any", columns);
  if (claims < tests) print_row("  at least one false claim holds", curve, "any_false", columns);
  if (!hypothesis.at("paper_rule").get<std::string>().empty())
    print_row("  by the paper's rule", curve, "paper_rule", columns);
  if (!hypothesis.at("n_for_power").is_null())
    std::printf("    power %g from n = %d\n", settings.at("power").get<double>(),
                hypothesis.at("n_for_power").get<int>());
}

/// Prints the power of each single test: with Holm's correction, without it, and by formula. Only for a
/// request with one number of participants.
void print_tests(const study::Json& hypothesis) {
  for (const auto& test : hypothesis.at("tests")) {
    const study::Json& at = test.at("curve").at(0);
    const study::Json& closed = at.at("closed_form");
    std::printf("    %-36s truth %6.3g  holds %s  uncorrected %s  formula %s\n",
                test.at("label").get<std::string>().c_str(), test.at("truth").get<double>(),
                cell(at, "holds").c_str(), cell(at, "uncorrected").c_str(),
                closed.is_number() ? fmt::format("{:.3f}", closed.get<double>()).c_str() : "-");
  }
}

void print_worlds(const study::Json& json) {
  const auto columns = columns_to_print(json);
  for (const auto& world : json.at("worlds")) {
    std::printf("\nWorld \"%s\": %s\n", world.at("id").get<std::string>().c_str(),
                world.at("words").get<std::string>().c_str());
    print_head(json, columns);
    for (const auto& hypothesis : world.at("hypotheses")) {
      print_hypothesis(hypothesis, json.at("settings"), columns);
      if (columns.size() == 1) print_tests(hypothesis);
    }
  }
}

void print_n(const char* name, const study::Json& n) {
  if (n.is_null())
    std::printf("  %s: not reached\n", name);
  else
    std::printf("  %s: n = %d\n", name, n.get<int>());
}

void print_coefficient(const study::Json& json, const std::string& name, const char* unit,
                       const std::vector<std::size_t>& columns) {
  study::Json curve = study::Json::array();
  for (const auto& point : json.at("precision").at("curve")) curve.push_back(point.at(name));
  const int decimals = name == "a" ? 2 : 4;
  std::printf("%s, %s\n", name.c_str(), unit);
  print_row("mean", curve, "mean", columns, decimals);
  print_row("standard error (of estimates)", curve, "sd", columns, decimals);
  print_row("interval's half width, median", curve, "half_width", columns, decimals);
  print_row("coverage of the interval", curve, "coverage", columns);
  if (json.at("settings").at("precision_" + name).is_number())
    print_row("precision reached", curve, "reached", columns);
}

void print_precision(const study::Json& json) {
  const auto columns = columns_to_print(json);
  std::printf("question \"%s\", the curve at level %g of its scale\n",
              json.at("settings").at("question").get<std::string>().c_str(),
              json.at("settings").at("level").get<double>());
  const study::Json& truth = json.at("settings").at("observer");
  std::printf(
      "simulated people, as --observer gives them: true a = %g frames/s, true b = %g s/frame, %g points "
      "for each frame/s, SD of the answers %g and of people %g\n",
      truth.at("a").get<double>(), truth.at("b").get<double>(), truth.at("slope").get<double>(),
      truth.at("noise").get<double>(), truth.at("participant_sd").get<double>());
  for (const auto& other : json.at("settings").at("other_questions"))
    std::printf("not in this calculation: question \"%s\"; choose it with --question %s\n",
                other.get<std::string>().c_str(), other.get<std::string>().c_str());
  std::printf("\n");
  print_head(json, columns);
  print_row("pilots with an interval", json.at("precision").at("curve"), "interval", columns);
  print_coefficient(json, "a", "frames/s", columns);
  print_coefficient(json, "b", "s/frame", columns);
  const study::Json &precision = json.at("precision"), &settings = json.at("settings");
  const bool a = settings.at("precision_a").is_number(), b = settings.at("precision_b").is_number();
  if (a || b)
    std::printf("requested precision, reached in a share of %g of pilots:\n",
                settings.at("power").get<double>());
  if (a) print_n("a", precision.at("n_for_a"));
  if (b) print_n("b", precision.at("n_for_b"));
  if (a && b) print_n("both", precision.at("n_for_both"));
}

}  // namespace

void print_power(const study::PowerRequest& request, const study::Json& json) {
  std::printf(
      "%s %s (SHA-256 %s), %d simulated studies for each n, seed %llu; in brackets: Monte-Carlo "
      "standard error\n",
      request.protocol.name.c_str(), request.protocol.version.c_str(),
      request.protocol.sha256.substr(0, 12).c_str(), request.studies,
      static_cast<unsigned long long>(request.seed));
  const auto& shared = request.person_by_method;
  if (shared.realism != 0 || shared.sickness != 0)
    std::printf("share of person by method in the variance of answers: realism %.2f, cybersickness %.2f\n",
                shared.realism, shared.sickness);
  json.contains("precision") ? print_precision(json) : print_worlds(json);
}

}  // namespace apps
