#include "apps/study/session_player.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <optional>

#include "apps/common/program.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/pacing/real_time.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/status.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

std::atomic<bool> stop_flag = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void ask_to_stop(int) { stop_flag = true; }

std::size_t trials_left(const study::OpenRun& run) {
  std::size_t count = 0;
  for (const auto& session : run.sessions) count += session.trials.size();
  return count;
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

void play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
              SessionSetup& setup, const PlayOptions& options) {
  std::size_t done = 0;
  Progress progress("trials", trials_left(run));
  study::SessionHooks hooks;
  hooks.stop = StopSignals::stop_wished;
  hooks.answered = [&](const study::TrialDone& trial) {
    progress.update(++done);
    if (!options.events) return;
    std::printf("answered %s %d attempt %d\n", trial.participant.c_str(), trial.position, trial.attempt);
    std::fflush(stdout);
  };
  std::optional<study::RealTimeScheduling> real_time;
  if (!setup.virtual_clock) real_time.emplace();
  study::SessionParts parts{*setup.clock,     *setup.display, *setup.stimulus,
                            *setup.responder, store,          setup.virtual_clock};
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
