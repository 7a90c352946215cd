#pragma once
/// Plays what a database says is left to do; shared by run and resume.

#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// While it lives, SIGINT, SIGTERM, SIGHUP (unless it was ignored, as nohup does) and SIGPIPE ask the session
/// to stop at the next frame: a terminal that goes away ends it in order.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  static bool stop_wished();

 private:
  std::vector<std::pair<int, struct sigaction>> before_;
};

/// Tells on stderr who keeps the database locked, after a second and every ten from then on; waits until the
/// lock is gone or a stop is wished.
study::sqlite::Waiting tell_of_locks(const std::filesystem::path& database);

/// Options of run and resume that say how they talk and how far the file may grow.
struct PlayOptions {
  std::filesystem::path database;
  std::int64_t max_pages = 0;  ///< 0 = no limit
  bool console = false;        ///< the experimenter's, in the terminal
  bool accept_slow = false;    ///< see RunOptions
  bool events = false;         ///< a line on stdout for each unit done, once it is committed, without answers
  bool mirror = false;         ///< the experimenter sees the participant's pages in a second window
  bool mirror_reveal = false;  ///< and stimuli, which are black else
};

/// Opens the mirror where it is asked for. base::Error when there is no window, or no room for a second one.
void open_mirror(const PlayOptions& options, const SessionSetup& setup);

/// How a person's sessions ended, of several the last of these that fits one; those of observers are Done.
enum class RunEnd {
  Done,
  TurnedAway,  ///< consent was refused, or an answer ruled the person out
  Stopped      ///< by the participant, a stop rule or the experimenter
};

/// Plays all sessions of an open run with a progress bar, and says which ended early. base::Error that names
/// resume when it was stopped on request.
RunEnd play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
                SessionSetup& setup, const PlayOptions& options);

/// What is left to do when a command has played and closed its database.
struct Played {
  RunEnd end = RunEnd::Done;
  std::vector<std::string> withdraw;  ///< participants who wished it at the end
};

/// Carries out the withdrawals, then ends the command with the exit status of sessions that ended early: 3
/// stopped, 4 turned away.
void end_command(const std::filesystem::path& database, const Played& played);
/// The same in words, for --help.
extern const char* const exit_status_help;

/// One line a setting; nothing where no schedule was played: nominal, realised mu and delta, late frames,
/// verdicts, grade.
void print_certificate(const std::filesystem::path& database, const study::OpenRun& run,
                       const study::Protocol& protocol);

}  // namespace apps
