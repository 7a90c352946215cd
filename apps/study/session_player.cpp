#include "apps/study/session_player.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <functional>
#include <optional>

#include "apps/study/clean_up.hpp"
#include "apps/study/station_warnings.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libstudy/console/certificate.hpp"
#include "libstudy/console/console.hpp"
#include "libstudy/console/progress.hpp"
#include "libstudy/console/terminal.hpp"
#include "libstudy/pacing/real_time.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "libstudy/store/read/session_counts.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/duration.hpp"
#include "stats/base/error.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/streams.hpp"

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

}  // namespace

StopSignals::StopSignals() {
  stop_flag = false;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    before_.emplace_back(signal, before);
    std::signal(signal, ask_to_stop);
  }
}

StopSignals::~StopSignals() {
  for (const auto& [signal, before] : before_) ::sigaction(signal, &before, nullptr);
}

bool StopSignals::stop_requested() { return stop_flag; }

study::sqlite::Waiting tell_of_locks(const std::filesystem::path& database) {
  return [database, calls = 0](const std::string& holder) mutable {
    if (calls++ % 10 == 0) {
      std::fprintf(stderr, "%s%s: %s keeps it locked; waiting, nothing is lost. Close it there.\n",
                   ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "",
                   base::for_terminal(database.string()).c_str(), base::for_terminal(holder).c_str());
    }
    return !StopSignals::stop_requested();
  };
}

void open_mirror(const PlayOptions& options, const study::SessionSetup& setup) {
  if (!options.mirror) return;
  if (!setup.open_mirror)
    throw base::Error(
        "--mirror", "there is no participant's window to mirror",
        "leave it out: only sessions that vip-study run began with --display window or openxr have one");
  setup.open_mirror(options.mirror_reveal);
}

void tell_of_patch(const study::SessionSetup& setup) {
  if (setup.light_patch.empty()) return;
  std::fprintf(stderr, "light patch: %s; it flashes, so cover it with the sensor: nobody may see it\n",
               setup.light_patch.c_str());
}

void open_markers(PlayOptions& options, bool virtual_clock) {
  if (options.markers.empty()) return;
  if (virtual_clock)
    throw base::Error("--markers", "a session on the virtual clock has no real time to mark",
                      "leave --markers out, or run with --clock real");
  if (!options.senders)
    options.senders = std::make_shared<study::MarkerSenders>(options.markers, options.pulse);
}

namespace {

void print_begins(const study::OpenSession& session, const study::OpenUnit& unit,
                  const study::Protocol& protocol) {
  const auto& block = protocol.blocks.at(static_cast<std::size_t>(unit.plan.block));
  std::printf("begins %s %d %s %s\n", session.plan.participant.c_str(), unit.plan.position,
              study::block_kind_name(block.kind).c_str(), block.id.c_str());
  std::fflush(stdout);
}

void print_done(const study::UnitDone& unit, const study::Protocol& protocol) {
  const auto& block = protocol.blocks.at(static_cast<std::size_t>(unit.unit.block));
  std::printf("done %s %d %s attempt %d\n", unit.participant.c_str(), unit.unit.position,
              study::block_kind_name(block.kind).c_str(), unit.attempt);
  std::fflush(stdout);
}

/// Reports the events of a run to the console or the progress bar, and passes the requests of the console to
/// the session.
class Steering {
 public:
  Steering(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
           const study::SessionSetup& setup, const PlayOptions& options, std::vector<std::string> warnings)
      : store_(store),
        protocol_(protocol),
        window_(setup.request),
        events_(options.events),
        markers_(options.senders.get()),
        warnings_(std::move(warnings)) {
    if (options.console) {
      console_.emplace(protocol, store, options.database, setup.idle,
                       study::showing_times(protocol, setup.rates));
      terminal_.emplace(*console_);
    } else {
      progress_.emplace("session steps", units_left(run));
      if (setup.listen) setup.listen();
    }
    if (console_) store.tell_of_journal([this](const std::string& line) { console_->warn(line); });
  }
  ~Steering() { store_.tell_of_journal({}); }
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  study::SessionHooks hooks(const study::OpenSession& session) {
    if (console_) console_->begin(session);
    for (const std::string& warning : warnings_) {
      if (console_) console_->warn(warning);
    }
    study::SessionHooks hooks;
    if (markers_) hooks.mark = [this](const study::Marker& marker) { markers_->send(marker); };
    hooks.begins = [this, &session](const study::OpenUnit& unit) {
      report_markers();
      if (console_) console_->begins(unit);
      if (events_) print_begins(session, unit, protocol_);
    };
    if (console_) hooks.ends = [this](const study::Ending& ending) { console_->ends(ending); };
    if (console_) hooks.shown = [this](const study::FrameRecord& frame) { console_->shown(frame); };
    hooks.done = [this, &session](const study::UnitDone& unit) {
      if (markers_) store_.add_markers(session.id, markers_->take());
      report_markers();
      if (progress_) progress_->update(++done_);
      if (console_) console_->done(unit);
      if (events_) print_done(unit, protocol_);
    };
    hooks.trouble = [this](const study::Trouble& trouble) {
      if (console_) {
        console_->trouble(trouble);
      } else {
        std::fprintf(stderr, "%sPAUSED: %s.\n%s. Then go on at the participant's page.\a\n",
                     ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", trouble.what.c_str(),
                     trouble.mend.c_str());
      }
      return console_.has_value();
    };
    hooks.request = [this] { return window_ ? window_([this] { return others(); }) : others(); };
    return hooks;
  }

  /// Call it when a session is over, however it ended: stores the rest of its markers.
  void store_markers(const study::OpenSession& session) {
    if (!markers_) return;
    store_.add_markers(session.id, markers_->take_settled());
    report_markers();
  }

  /// True if the console has reopened trials that must be shown again.
  bool take_reopened() { return console_ && console_->take_reopened(); }

 private:
  void report_markers() {
    if (!markers_) return;
    for (const std::string& news : markers_->take_news()) {
      if (console_)
        console_->warn(news);
      else
        std::fprintf(stderr, "%s%s\n", ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "",
                     base::for_terminal(news).c_str());
    }
  }

  study::Request others() {
    if (StopSignals::stop_requested()) return study::Request::Stop;
    return console_ ? console_->request() : study::Request::GoOn;
  }

  study::Store& store_;
  const study::Protocol& protocol_;
  const study::WindowRequest& window_;
  bool events_;
  study::MarkerSenders* markers_;      ///< null: no markers are sent
  std::vector<std::string> warnings_;  ///< station warnings for the console
  std::size_t done_ = 0;
  std::optional<base::Progress> progress_;
  std::optional<study::Console> console_;
  std::optional<study::ConsoleTerminal> terminal_;
};

/// Prints the expected duration of all sessions on stderr. Call it only for sessions in real time.
void print_length(const study::OpenRun& run, const study::Protocol& protocol,
                  const study::SessionSetup& setup) {
  const bool person = !setup.participant->simulated();
  const auto showing_s = study::showing_times(protocol, setup.rates);
  double seconds = 0;
  for (const auto& session : run.sessions)
    seconds += study::expected_s(protocol, session.units, person, showing_s);
  std::fprintf(stderr, "%s: %zu session%s in real time, about %s\n",
               base::for_terminal(protocol.name).c_str(), run.sessions.size(),
               run.sessions.size() == 1 ? "" : "s", base::duration_words(seconds).c_str());
}

/// Reads the session from the store again; none if the session has no open unit.
std::optional<study::OpenSession> read_open_session(study::Store& store, std::int64_t id) {
  for (study::OpenRun& run : store.open_runs()) {
    for (study::OpenSession& session : run.sessions) {
      if (session.id == id) return std::move(session);
    }
  }
  return {};
}

/// A person's session that ended before its last unit.
struct EndedEarly {
  std::string participant;
  study::Ending ending;
};

RunEnd tell_end(const EndedEarly& early) {
  const bool refused = early.ending.how == study::EarlyEnd::Refused;
  const bool turned_away = refused || early.ending.how == study::EarlyEnd::NotEligible;
  std::printf("%s %s: the session is over, nothing is left to do of it\n", early.participant.c_str(),
              refused       ? "did not consent"
              : turned_away ? "is not eligible"
                            : "stopped before the end");
  return turned_away ? RunEnd::TurnedAway : RunEnd::Stopped;
}

/// Prints which sessions ended early, and a summary of each session; if a run has several sessions, only of
/// people's sessions. Call after the console's screen has closed.
RunEnd tell_ends(const study::OpenRun& run, const std::vector<EndedEarly>& all,
                 const std::filesystem::path& database) {
  RunEnd end = RunEnd::Done;
  for (const EndedEarly& early : all) end = std::max(end, tell_end(early));
  for (const study::OpenSession& session : run.sessions) {
    if (session.plan.observer && run.sessions.size() > 1) continue;
    std::fputs(study::summary_of(study::count_session(database, session.id)).c_str(), stdout);
  }
  return end;
}

void log_mirror(study::Store& store, const study::OpenSession& session, const study::SessionSetup& setup,
                bool reveals) {
  store.log(session.id, reveals ? study::mirror_event : study::pages_mirror_event,
            reveals ? "the experimenter sees the participant's view"
                    : "the experimenter sees the participant's pages; stimuli are black",
            setup.clock->now_ns());
}

void play_sessions(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
                   study::SessionSetup& setup, const PlayOptions& options, std::vector<EndedEarly>& early) {
  std::optional<study::RealTimeScheduling> real_time;
  if (!setup.virtual_clock) {
    real_time.emplace();
    print_length(run, protocol, setup);
  }
  std::optional<study::PersonalFile> personal;
  if (asks_personal(protocol)) personal.emplace(options.database);
  study::SessionParts parts{*setup.clock,       *setup.display, *setup.stimuli,
                            *setup.participant, store,          personal ? &*personal : nullptr,
                            setup.virtual_clock};
  parts.gaze = setup.gaze.get();
  parts.slots = setup.slots.get();
  parts.targets = setup.targets.get();
  auto warnings = check_station(store, run, protocol, setup, options.database);
  if (setup.rates.too_slow) warnings.emplace_back("live cells: not all reach their setting on this station");
  Steering steering(store, run, protocol, setup, options, warnings);
  const auto play = [&](const study::OpenSession& session) {
    const auto ending = [&] {
      try {
        return study::run_session(protocol, session, parts, steering.hooks(session));
      } catch (...) {
        try {
          steering.store_markers(session);
        } catch (const std::exception&) {  // the first error is reported
        }
        throw;
      }
    }();
    steering.store_markers(session);
    if (ending && !session.plan.observer) early.push_back({session.plan.participant, *ending});
  };
  for (const auto& session : run.sessions) {
    if (real_time) store.log(session.id, "scheduling", real_time->note(), setup.clock->now_ns());
    if (options.mirror) log_mirror(store, session, setup, options.mirror_reveal);
    if (!setup.rates.cells.empty())
      store.log(session.id, "live rates", study::measured_table(setup.rates), setup.clock->now_ns());
    if (const auto costs = study::frame_costs(setup.rates); !costs.empty())
      store.log(session.id, study::frame_costs_event, study::format_frame_costs(costs),
                setup.clock->now_ns());
    play(session);
    while (steering.take_reopened()) {
      if (const auto again = read_open_session(store, session.id)) play(*again);
    }
  }
}

}  // namespace

void end_command(const std::filesystem::path& database, const Played& played) {
  for (const std::string& participant : played.withdraw) withdraw_and_tell(database, participant);
  if (played.end == RunEnd::Stopped) throw CLI::RuntimeError(3);
  if (played.end == RunEnd::TurnedAway) throw CLI::RuntimeError(4);
}

const char* const exit_status_help =
    "Exit status: 0 done; 1 an error; 2 a wrong command line; 3 a person's session was stopped before its "
    "end;\n"
    "4 a person did not consent or is not eligible.";

RunEnd play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
                study::SessionSetup& setup, const PlayOptions& options) {
  std::vector<EndedEarly> early;
  const auto tell = [&] {
    sim::print_guards("live fluid", setup.stimuli->guards(), {});
    if (options.senders) std::fputs(options.senders->take_summary().c_str(), stdout);
    return tell_ends(run, early, options.database);
  };
  try {
    play_sessions(store, run, protocol, setup, options, early);
  } catch (const study::Stopped&) {
    tell();
    throw base::Error(options.database.string(), "stopped on request; all answers given are kept",
                      "continue with vip-study resume --db " + options.database.string());
  }
  return tell();
}

void print_certificate(const std::filesystem::path& database, const study::OpenRun& run,
                       const study::Protocol& protocol) {
  const auto rows = study::read_certificate(database, run.id, protocol.pacing.mean);
  const bool coloured = ::isatty(STDOUT_FILENO) == 1;
  base::print_coloured(study::format_certificate(rows, protocol.pacing.mean, coloured));
}

}  // namespace apps
