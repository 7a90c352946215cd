/// vip-study markers: prints the codes of markers, and tries a receiver.
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "apps/common/options.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/markers/marker_sender.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

struct MarkerOptions {
  std::string receiver;
  study::MarkerPulse pulse;
  int count = 100;
  int interval_ms = 100;
};

/// Sends test markers at even intervals and prints how long each took.
void try_receiver(const MarkerOptions& options) {
  study::MarkerSenders senders({options.receiver}, options.pulse);
  study::RealClock clock;
  std::int64_t due_ns = clock.now_ns();
  for (int i = 0; i < options.count; ++i) {
    clock.wait_until(due_ns);
    study::Marker marker;
    marker.position = i;
    marker.clock_ns = clock.now_ns();
    senders.send(marker);
    due_ns += 1'000'000LL * options.interval_ms;
  }
  senders.finish();
  std::string lost;
  int lost_count = 0;
  for (const study::MarkerRecord& record : senders.take()) {
    lost_count += record.lost.empty() ? 0 : 1;
    if (lost.empty()) lost = record.lost;
  }
  std::fputs(senders.take_summary().c_str(), stdout);
  if (lost_count > 0)
    throw base::Error(
        "markers to " + options.receiver,
        std::to_string(lost_count) + " of " + std::to_string(options.count) + " were lost: " + lost,
        "check that the receiver is on and reads, or send less often with --interval-ms");
}

void print_or_test_markers(const MarkerOptions& options, bool test) {
  if (test)
    try_receiver(options);
  else
    std::fputs(study::marker_code_table().c_str(), stdout);
}

}  // namespace

void add_markers_command(CLI::App& app) {
  auto options = std::make_shared<MarkerOptions>();
  CLI::App& sub = *app.add_subcommand(
      "markers", "Print the codes of --markers for EEG and eye trackers, or try a receiver of markers");
  auto* test =
      sub.add_option("--test", options->receiver,
                     "Receiver, as --markers of run names it: sends test markers to it and prints how "
                     "long each took from the event to the completed write");
  sub.add_option("--count", options->count, "Number of test markers")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->needs(test);
  sub.add_option("--interval-ms", options->interval_ms, "Time from one test marker to the next, ms")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str()
      ->needs(test);
  add_marker_pulse(sub, test, options->pulse);
  sub.callback([options, test] { print_or_test_markers(*options, test->count() > 0); });
}

}  // namespace apps
