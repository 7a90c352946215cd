/// vip-study check: what a display with a fixed refresh makes of a protocol.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/common/program.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/refresh_check.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

// What an answer takes people, from quick to slow, seconds; only the printed duration depends on it.
constexpr double quick_answer_s = 2, slow_answer_s = 6;

struct CheckOptions {
  std::string protocol;
  double refresh_hz = 0;
  std::string json;
};

double longest_ms(const RefreshCheck& check, std::size_t setting) {
  return 1000 * check.verdicts[setting].longest_hold / check.refresh_hz;
}

std::vector<RefreshCheck> check_common(const study::Protocol& protocol) {
  std::vector<RefreshCheck> checks;
  Progress progress("refresh rates", common_refreshes.size());
  for (const double refresh_hz : common_refreshes) {
    checks.push_back(check_refresh(protocol, refresh_hz));
    progress.update(checks.size());
  }
  return checks;
}

void print_table(const study::Protocol& protocol, const RefreshCheck& check) {
  std::printf("%s %s on %g Hz, %s mean\n\n", protocol.name.c_str(), protocol.version.c_str(),
              check.refresh_hz, protocol.pacing.mean == study::FpsMean::Harmonic ? "harmonic" : "arithmetic");
  std::printf("%-10s %6s  %-11s %9s %8s %11s  %s\n", "setting", "frames", "status", "mean", "sd",
              "longest ms", "why not exact");
  for (std::size_t i = 0; i < protocol.settings.size(); ++i) {
    const auto& verdict = check.verdicts[i];
    std::printf("%-10s %6lld  %-11s", study::setting_name(protocol.settings[i]).c_str(),
                static_cast<long long>(verdict.frames), study::feasibility_name(verdict.feasibility).c_str());
    if (verdict.holds.empty())
      std::printf(" %9s %8s %11s", "-", "-", "-");
    else
      std::printf(" %9.4f %8.4f %11.1f", verdict.mean, verdict.sd, longest_ms(check, i));
    std::printf("  %s\n", verdict.reason.c_str());
  }
  std::printf("\n%d exact, %d approximate, %d unreachable of %zu\n", check.exact, check.approximate,
              check.unreachable, protocol.settings.size());
}

void print_refusal(const study::Protocol& protocol, const RefreshCheck& check) {
  if (check.unreachable > 0) {
    std::printf("run refuses this protocol on %g Hz: %d settings are unreachable\n", check.refresh_hz,
                check.unreachable);
  } else if (check.approximate > 0 && !protocol.accept_approximate) {
    std::printf("run refuses approximate settings unless the protocol says accept_approximate = true\n");
  }
}

void print_common(const std::vector<RefreshCheck>& checks) {
  std::printf("\nexact settings by refresh:");
  for (const auto& check : checks) std::printf(" %g Hz %d;", check.refresh_hz, check.exact);
  const auto& best = best_refresh(checks);
  std::printf("\nbest of these: %g Hz, %d exact, mean distance to the unquantised rates %.2g frames/s\n",
              best.refresh_hz, best.exact, best.distance);
}

std::pair<double, double> speed_range(const study::Protocol& protocol) {
  double slow = HUGE_VAL, fast = 0;
  for (const auto& setting : protocol.settings) {
    slow = std::min(slow, play_speed(protocol, setting));
    fast = std::max(fast, play_speed(protocol, setting));
  }
  return {slow, fast};
}

void print_plan(const study::Protocol& protocol) {
  const auto [slow, fast] = speed_range(protocol);
  std::printf("play speed: %.2f to %.2f of real time (%s, content step %.4g ms): part of the stimulus\n",
              slow, fast, protocol.content.real_time ? "real_time" : "per_frame: mean x content_step_s",
              1000 * protocol.content.content_step_s);
  std::printf("plan: %zu trials, %.1f min of trials and gaps; with %g to %g s an answer %.1f to %.1f min\n",
              protocol.settings.size(), plan_seconds(protocol, 0) / 60, quick_answer_s, slow_answer_s,
              plan_seconds(protocol, quick_answer_s) / 60, plan_seconds(protocol, slow_answer_s) / 60);
}

nlohmann::ordered_json setting_json(const study::FpsSetting& setting, const study::RefreshVerdict& verdict,
                                    double refresh_hz) {
  nlohmann::ordered_json json{{"mean_fps", setting.mean},
                              {"sd_fps", setting.sd},
                              {"duration_s", setting.duration_s},
                              {"frames", verdict.frames},
                              {"status", study::feasibility_name(verdict.feasibility)},
                              {"reason", verdict.reason}};
  if (verdict.holds.empty()) return json;
  json["best_mean_fps"] = verdict.mean;
  json["best_sd_fps"] = verdict.sd;
  json["longest_hold_periods"] = verdict.longest_hold;
  json["longest_hold_ms"] = 1000 * verdict.longest_hold / refresh_hz;
  json["distance_fps"] = verdict.distance;
  return json;
}

nlohmann::ordered_json check_json(const study::Protocol& protocol, const RefreshCheck& check,
                                  const std::vector<RefreshCheck>& common) {
  const auto [slow, fast] = speed_range(protocol);
  nlohmann::ordered_json json{
      {"protocol", protocol.name},
      {"protocol_version", protocol.version},
      {"protocol_sha256", protocol.sha256},
      {"refresh_hz", check.refresh_hz},
      {"mean", protocol.pacing.mean == study::FpsMean::Harmonic ? "harmonic" : "arithmetic"},
      {"exact", check.exact},
      {"approximate", check.approximate},
      {"unreachable", check.unreachable},
      {"best_refresh_hz", best_refresh(common).refresh_hz},
      {"play_speed", {slow, fast}},
      {"plan_s", plan_seconds(protocol, 0)},
      {"plan_with_answers_s",
       {plan_seconds(protocol, quick_answer_s), plan_seconds(protocol, slow_answer_s)}}};
  for (const auto& rate : common) {
    json["common_refreshes"].push_back({{"refresh_hz", rate.refresh_hz},
                                        {"exact", rate.exact},
                                        {"approximate", rate.approximate},
                                        {"unreachable", rate.unreachable},
                                        {"distance_fps", rate.distance}});
  }
  for (std::size_t i = 0; i < protocol.settings.size(); ++i)
    json["settings"].push_back(setting_json(protocol.settings[i], check.verdicts[i], check.refresh_hz));
  return json;
}

void check_protocol(const CheckOptions& options) {
  const auto protocol = study::read_protocol(base::find_input(options.protocol));
  const auto check = check_refresh(protocol, options.refresh_hz);
  print_table(protocol, check);
  print_refusal(protocol, check);
  const auto common = check_common(protocol);
  print_common(common);
  print_plan(protocol);
  if (!options.json.empty())
    base::write_file_atomically(options.json, check_json(protocol, check, common).dump(2) + "\n");
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  auto* command =
      app.add_subcommand("check", "Say what a display with a fixed refresh makes of a protocol's settings");
  command->add_option("protocol", options->protocol, "Protocol file")->required();
  command->add_option("--refresh", options->refresh_hz, "The display's refresh in Hz")
      ->required()
      ->check(number_in(10, 1000));
  command->add_option("--json", options->json, "File for every number of the report");
  command->callback([options] { check_protocol(*options); });
}

}  // namespace apps
