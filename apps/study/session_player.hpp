#pragma once
/// Plays the open sessions of a database; shared by run and resume.

#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/runner/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// During its lifetime, SIGINT, SIGTERM, SIGHUP (unless ignored, as by nohup) and SIGPIPE ask the session to
/// stop at the next frame, so that closing the terminal ends it cleanly.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  static bool stop_requested();

 private:
  std::vector<std::pair<int, struct sigaction>> before_;
};

/// Prints on stderr which program locks the database, after a second and then every ten seconds; waits until
/// the lock is released or a stop is requested.
study::sqlite::Waiting tell_of_locks(const std::filesystem::path& database);

/// Options of run and resume for output and the file's size.
struct PlayOptions {
  std::filesystem::path database;
  std::int64_t max_pages = 0;  ///< 0 = no limit
  bool console = false;        ///< the experimenter's, in the terminal
  bool accept_slow = false;    ///< see RunOptions
  bool events = false;         ///< a line on stdout for each committed unit, without answers
  bool mirror = false;         ///< the experimenter sees the participant's pages in a second window
  bool mirror_reveal = false;  ///< and also stimuli, which are otherwise black
};

/// Opens the mirror if requested. base::Error if there is no window, or no room for a second one.
void open_mirror(const PlayOptions& options, const study::SessionSetup& setup);

/// How people's sessions ended: the last of these values that applies to any of them. Sessions of observers
/// are Done.
enum class RunEnd {
  Done,
  TurnedAway,  ///< consent was refused, or an answer excluded the person
  Stopped      ///< by the participant, a stop rule or the experimenter
};

/// Plays all sessions of an open run with a progress bar, and prints which ended early. base::Error naming
/// resume if it was stopped on request.
RunEnd play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
                study::SessionSetup& setup, const PlayOptions& options);

/// Work left after a command has played and closed its database.
struct Played {
  RunEnd end = RunEnd::Done;
  std::vector<std::string> withdraw;  ///< participants who requested it at the end
};

/// Carries out the withdrawals, then ends the command with the exit status of sessions that ended early: 3
/// stopped, 4 turned away.
void end_command(const std::filesystem::path& database, const Played& played);
/// The exit statuses as text for --help.
extern const char* const exit_status_help;

/// One line per setting: nominal, realised mu and delta, late frames, verdicts, grade. Prints nothing if no
/// schedule was played.
void print_certificate(const std::filesystem::path& database, const study::OpenRun& run,
                       const study::Protocol& protocol);

}  // namespace apps
