#include "apps/study/session_player.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <functional>
#include <optional>

#include "apps/common/program.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/pacing/real_time.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/status.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

std::atomic<bool> stop_flag = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void ask_to_stop(int) { stop_flag = true; }

std::size_t units_left(const study::OpenRun& run) {
  std::size_t count = 0;
  for (const auto& session : run.sessions) count += session.units.size();
  return count;
}

bool asks_personal(const study::Protocol& protocol) {
  const auto all = study::all_questions(protocol);
  return std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.second->personal; });
}

std::optional<stats::PtpeModel> ptpe_of(const study::OpenSession& session,
                                        const std::filesystem::path& database) {
  if (!session.plan.ptpe) return {};
  const std::string place = database.string() + ": PTPE file of " + session.plan.participant;
  return sim::parse_ptpe_file(*session.plan.ptpe, place).model;
}

}  // namespace

StopSignals::StopSignals() {
  stop_flag = false;
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
}

StopSignals::~StopSignals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

bool StopSignals::stop_wished() { return stop_flag; }

namespace {

void print_done(const study::UnitDone& unit, const study::Protocol& protocol) {
  const auto& block = protocol.blocks.at(static_cast<std::size_t>(unit.unit.block));
  std::printf("done %s %d %s attempt %d\n", unit.participant.c_str(), unit.unit.position,
              study::block_kind_name(block.kind).c_str(), unit.attempt);
  std::fflush(stdout);
}

study::SessionHooks make_hooks(const WindowWish& window, std::function<void(const study::UnitDone&)> done) {
  study::SessionHooks hooks;
  const auto others = [] { return StopSignals::stop_wished() ? study::Wish::Stop : study::Wish::GoOn; };
  hooks.wish = [window, others] { return window ? window(others) : others(); };
  hooks.done = std::move(done);
  return hooks;
}

}  // namespace

void play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
              SessionSetup& setup, const PlayOptions& options) {
  std::size_t done = 0;
  Progress progress("session steps", units_left(run));
  const auto hooks = make_hooks(setup.wish, [&](const study::UnitDone& unit) {
    progress.update(++done);
    if (options.events) print_done(unit, protocol);
  });
  std::optional<study::RealTimeScheduling> real_time;
  if (!setup.virtual_clock) real_time.emplace();
  std::optional<study::PersonalFile> personal;
  if (asks_personal(protocol)) personal.emplace(options.database);
  study::SessionParts parts{*setup.clock,       *setup.display, *setup.stimuli,
                            *setup.participant, store,          personal ? &*personal : nullptr,
                            setup.virtual_clock};
  try {
    for (const auto& session : run.sessions) {
      if (real_time) store.log(session.id, "scheduling", real_time->note(), setup.clock->now_ns());
      parts.ptpe = ptpe_of(session, options.database);
      study::run_session(protocol, session, parts, hooks);
    }
  } catch (const study::Stopped&) {
    throw base::Error(options.database.string(), "stopped on request; all answers given are kept",
                      "continue with vip-study resume --db " + options.database.string());
  }
}

void print_certificate(const std::filesystem::path& database, const study::OpenRun& run,
                       const study::Protocol& protocol) {
  const bool harmonic = protocol.pacing.mean == study::FpsMean::Harmonic;
  std::printf("Timing certificate (%s mean, frames/s; worst = largest distance of one trial)\n",
              harmonic ? "harmonic" : "arithmetic");
  std::printf("%6s %6s %7s %8s %7s %8s %7s %7s %8s %5s %9s %5s %s\n", "mu", "delta", "trials", "mu real",
              "worst", "d real", "worst", "late", "worst ms", "pass", "degraded", "fail", "grade");
  std::int64_t pass = 0, all = 0;
  for (const auto& row : study::read_certificate(database, run.id, protocol.pacing.mean)) {
    std::printf("%6g %6g %7lld %8.3f %7.3f %8.3f %7.3f %7lld %8.3f %5lld %9lld %5lld %s\n", row.nominal.mean,
                row.nominal.sd, static_cast<long long>(row.trials), row.mean, row.mean_worst, row.sd,
                row.sd_worst, static_cast<long long>(row.late), row.worst_late_ms,
                static_cast<long long>(row.pass), static_cast<long long>(row.degraded),
                static_cast<long long>(row.fail), row.grades.c_str());
    pass += row.pass;
    all += row.trials;
  }
  std::printf("%lld of %lld trials pass\n", static_cast<long long>(pass), static_cast<long long>(all));
}

}  // namespace apps
