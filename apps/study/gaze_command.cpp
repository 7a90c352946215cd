/// vip-study gaze: tries an eye tracker outside OpenXR, and the options of such trackers.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/trackers/eye_tracker.hpp"
#include "stats/base/error.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"
#include "stats/quantiles.hpp"

namespace apps {

namespace {

struct GazeOptions {
  std::string source;
  double seconds = 5;
  std::array<double, 3> turn_deg{};
};

constexpr std::chrono::milliseconds take_every{20}, offset_within{2500};

double milliseconds(std::int64_t ns) { return 1e-6 * static_cast<double>(ns); }

/// Samples of `seconds`, and the clock's offset before and after them.
struct GazeTrial {
  std::vector<study::TrackedGaze> samples;
  study::TrackerClock before, after;
  study::TrackerCounts counts;
  std::string trouble;
};

GazeTrial try_tracker(study::EyeTracker& tracker, double seconds) {
  GazeTrial out;
  out.before = tracker.clock();
  tracker.start();
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(take_every);
    const auto some = tracker.take();
    out.samples.insert(out.samples.end(), some.begin(), some.end());
  }
  out.trouble = tracker.trouble();
  out.counts = tracker.counts();
  tracker.stop();  // measures the offset again
  const auto waited = std::chrono::steady_clock::now() + offset_within;
  do {
    std::this_thread::sleep_for(take_every);
    out.after = tracker.clock();
  } while (out.after.clock_ns == out.before.clock_ns && std::chrono::steady_clock::now() < waited);
  return out;
}

std::string spread_of(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return fmt::format("median {:.2f} ms, 95 % {:.2f} ms, longest {:.2f} ms", stats::sorted_quantile(ms, 0.5),
                     stats::sorted_quantile(ms, 0.95), ms.back());
}

std::string direction_text(std::span<const study::TrackedGaze> samples) {
  std::array<double, 3> sum{};
  for (const study::TrackedGaze& sample : samples) {
    for (std::size_t k = 0; sample.valid && k < 3; ++k) sum[k] += sample.direction[k];
  }
  constexpr double degree = std::numbers::pi / 180;
  return fmt::format("on average {:.1f} degrees right, {:.1f} up", std::atan2(sum[0], -sum[2]) / degree,
                     std::atan2(sum[1], std::hypot(sum[0], sum[2])) / degree);
}

std::string clock_text(const study::TrackerClock& before, const study::TrackerClock& after) {
  const std::string trip = fmt::format("round trip {:.3f} ms", milliseconds(after.round_trip_ns));
  const std::string offset =
      fmt::format("offset {:.6f} s, right within {:.3f} ms ({})", 1e-9 * static_cast<double>(after.offset_ns),
                  milliseconds(after.round_trip_ns) / 2, trip);
  if (after.clock_ns == before.clock_ns) return offset + "; not measured again";
  return offset + fmt::format("; it changed by {:.3f} ms in {:.1f} s",
                              milliseconds(after.offset_ns - before.offset_ns),
                              1e-9 * static_cast<double>(after.clock_ns - before.clock_ns));
}

void print_trial(const GazeTrial& trial, const std::string& source, const std::string& device,
                 double seconds) {
  const auto row = [](const char* name, const std::string& text) { fmt::print("{:<12}{}\n", name, text); };
  row("tracker", base::for_terminal(device) + ", from " + base::for_terminal(source));
  const std::size_t count = trial.samples.size();
  const auto valid = static_cast<std::size_t>(
      std::count_if(trial.samples.begin(), trial.samples.end(), [](const auto& one) { return one.valid; }));
  row("samples", fmt::format("{} in {:g} s, {:.1f} a second; {:.1f} % valid", count, seconds,
                             static_cast<double>(count) / seconds,
                             count > 0 ? 100 * static_cast<double>(valid) / static_cast<double>(count) : 0));
  std::vector<double> intervals, delays;
  for (std::size_t i = 0; i < count; ++i) {
    const study::TrackedGaze& sample = trial.samples[i];
    delays.push_back(milliseconds(sample.arrived_ns - sample.sampled_ns));
    if (i > 0) intervals.push_back(milliseconds(sample.sampled_ns - trial.samples[i - 1].sampled_ns));
  }
  if (!intervals.empty()) row("intervals", spread_of(intervals));
  if (!delays.empty()) row("arrival", "after the sample: " + spread_of(delays));
  row("clock", clock_text(trial.before, trial.after));
  const study::TrackerCounts& counts = trial.counts;
  row("refused", fmt::format("{} unreadable, {} not after the sample before, {} with times far from arrival, "
                             "{} too many",
                             counts.unreadable, counts.backwards, counts.far, counts.overflow));
  if (valid > 0) row("direction", direction_text(trial.samples));
  if (!intervals.empty() && *std::max_element(intervals.begin(), intervals.end()) > 100)
    row("note", "a gap of over 100 ms between samples cuts a trial");
  if (count > 0 && valid == 0) row("note", "no sample is valid: the tracker does not see the eyes");
}

void test_gaze(const GazeOptions& options) {
  study::EyeTracker tracker(options.source, options.turn_deg);
  tell_of_network(options.source);
  const GazeTrial trial = try_tracker(tracker, options.seconds);
  print_trial(trial, options.source, tracker.device(), options.seconds);
  if (trial.samples.empty() || !trial.trouble.empty())
    throw base::Error(
        "gaze from " + options.source,
        trial.samples.empty() && trial.trouble.empty() ? "no usable sample came" : trial.trouble,
        "check the sender and its lines; docs/headset.md has the format");
}

}  // namespace

std::string gaze_source_problem(const std::string& text) {
  for (const char* word : {"fixed", "mouse", "head", "tracked", "none"}) {
    if (text == word) return "";
  }
  if (study::is_outside_tracker(text) && text.size() > 4 && text.size() <= 200) return "";
  return "'" + base::shortened(text) +
         "' is not fixed, mouse, head, tracked, none, tcp:[HOST:]PORT or lsl:NAME";
}

void add_gaze_turn(CLI::App& command, std::array<double, 3>& turn_deg) {
  command
      .add_option_function<std::string>(
          "--gaze-turn",
          [&turn_deg](const std::string& text) {
            const auto parts = base::split(text);
            std::array<double, 3> found{};
            bool good = parts.size() == found.size();
            for (std::size_t k = 0; good && k < found.size(); ++k) {
              const auto angle = base::parse_number<double>(parts[k]);
              good = angle && std::abs(*angle) <= 180;
              found[k] = angle.value_or(0);
            }
            if (!good)
              throw CLI::ValidationError("--gaze-turn",
                                         "write three angles within 180 degrees, such as 0,-2.5,0");
            turn_deg = found;
          },
          "Fixed rotation of the rays of an eye tracker outside OpenXR, degrees: to the left, up, leaning to "
          "the left")
      ->type_name("LEFT,UP,LEAN");
}

void tell_of_network(const std::string& gaze) {
  if (!study::is_outside_tracker(gaze) || !study::crosses_network(gaze)) return;
  std::fprintf(stderr,
               "gaze from %s: crosses a network without encryption, and gaze is personal data: use a network "
               "of the lab's own\n",
               base::for_terminal(gaze).c_str());
}

void add_gaze_command(CLI::App& app) {
  auto options = std::make_shared<GazeOptions>();
  CLI::App& sub = *app.add_subcommand("gaze", "Try an eye tracker outside OpenXR: do its samples arrive?");
  sub.add_option("--test", options->source,
                 "The eye tracker, as --gaze of run names it: tcp:[HOST:]PORT or lsl:NAME. Nothing is kept")
      ->required()
      ->check([](const std::string& text) {
        const bool good = study::is_outside_tracker(text) && gaze_source_problem(text).empty();
        return good ? "" : "'" + base::shortened(text) + "' is not tcp:[HOST:]PORT or lsl:NAME";
      });
  sub.add_option("--seconds", options->seconds, "How long samples are taken, s")
      ->check(number_in(0.1, 3600))
      ->capture_default_str();
  add_gaze_turn(sub, options->turn_deg);
  sub.callback([options] { test_gaze(*options); });
}

}  // namespace apps
