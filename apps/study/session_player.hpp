#pragma once
/// Plays the open sessions of a database, for vip-study run and resume.

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/markers/marker_sender.hpp"
#include "libstudy/runner/session_setup.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// While this object exists, the signals SIGINT, SIGTERM, SIGPIPE and SIGHUP set stop_requested(). Sessions
/// and bakes then end cleanly at the next frame, also when the terminal is closed. SIGHUP stays ignored if
/// the program started with SIGHUP ignored, as under nohup.
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

/// Makes the function that is called about once a second while another program locks the database. Every
/// tenth call, from the first on, prints the name of that program on stderr. The waiting ends when the lock
/// is released or a stop is requested.
study::sqlite::Waiting tell_of_locks(const std::filesystem::path& database);

/// Options that vip-study run and resume share.
struct PlayOptions {
  std::filesystem::path database;
  std::int64_t max_pages = 0;  ///< 0 = no limit
  bool console = false;        ///< the experimenter's console in the terminal
  bool accept_slow = false;    ///< also play cells computed live that are too slow here
  bool events = false;  ///< print a line on stdout for each begun and each committed unit, without answers
  bool mirror = false;  ///< the experimenter sees the participant's pages in a second window
  bool mirror_reveal = false;        ///< the second window also shows stimuli, which are otherwise black
  std::vector<std::string> markers;  ///< receivers of markers (study::open_marker_receiver())
  study::MarkerPulse pulse;
  std::shared_ptr<study::MarkerSenders> senders;  ///< the opened receivers; null: none
};

/// Opens options.markers unless they are open. base::Error if one cannot be reached, or on a virtual clock.
void open_markers(PlayOptions& options, bool virtual_clock);

/// Says on standard error where the patch for a light sensor is, if the session has one.
void tell_of_patch(const study::SessionSetup& setup);

/// Opens the experimenter's second window if options.mirror is set. base::Error if there is no participant's
/// window or if the second window cannot be opened.
void open_mirror(const PlayOptions& options, const study::SessionSetup& setup);

/// How the sessions of a run ended: the largest value over all sessions of people. Sessions of observers
/// (simulated participants) count as Done.
enum class RunEnd {
  Done,
  TurnedAway,  ///< consent was refused, or an answer excluded the person
  Stopped      ///< a session was stopped by the participant, a stop rule or the experimenter
};

/// Plays all sessions of an open run, with the console or a progress bar. Prints which sessions ended early,
/// and summaries. If the run is stopped on request, base::Error whose remedy is vip-study resume.
RunEnd play_run(study::Store& store, const study::OpenRun& run, const study::Protocol& protocol,
                study::SessionSetup& setup, const PlayOptions& options);

/// Result of the played sessions, and the withdrawals to carry out after the database is closed.
struct Played {
  RunEnd end = RunEnd::Done;
  std::vector<std::string> withdraw;  ///< participants who asked for deletion at the end of their session
};

/// Carries out the withdrawals. Then, if a session ended early, ends the command with exit status 3 (stopped)
/// or 4 (turned away).
void end_command(const std::filesystem::path& database, const Played& played);
/// The exit statuses as text for --help.
extern const char* const exit_status_help;

/// Prints the timing certificate of a run: a heading; for each cell whose showings were answered, a line with
/// nominal and realised mean and standard deviation of the frame rate, late frames, verdicts and grades; the
/// number of trials that pass. Prints nothing if no showing was answered.
void print_certificate(const std::filesystem::path& database, const study::OpenRun& run,
                       const study::Protocol& protocol);

}  // namespace apps
