#pragma once
/// The experimenter's console: shows the running session and controls it by keys.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/console/console_screen.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Hides method, frame rate and all hints at them until they are revealed, which is logged. Two threads use
/// it: the session's, and the one that reads keys. The latter commits the change that a key requests at once,
/// even during a trial, and confirms it afterwards; on failure it says "NOT KEPT" and the session goes on.
class Console {
 public:
  /// Seconds since the participant's last key, button or movement of the mouse; none: not known.
  using Idle = std::function<std::optional<double>()>;

  /// showing_s: see expected_s(); empty: planned durations.
  Console(const Protocol& protocol, Store& store, std::filesystem::path database, Idle idle = {},
          std::vector<double> showing_s = {});
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Called on the session's thread: the begin of a session, then its hooks. request() returns each cut only
  /// once.
  void begin(const OpenSession& session);
  void begins(const OpenUnit& unit);
  void shown(const FrameRecord& frame);
  void done(const UnitDone& unit);
  void ends(const Ending& ending);
  Request request();
  /// The session pauses until key p: an alarm says why and what to do.
  void trouble(const Trouble& trouble);
  /// Adds an alarm for the rest of this session, such as a problem of the station.
  void warn(const std::string& alarm);
  /// True if trials were reopened that this session has already passed; resets the flag. If false, the
  /// session is over and keys do nothing until the next one begins.
  bool take_reopened();

  /// Called on the key thread: handles one typed byte.
  void key(char byte);
  /// New lines to write since the last call.
  std::vector<std::string> take_lines();
  /// The content of the screen without `said`; now_ns: of the steady clock.
  ConsoleView view(std::int64_t now_ns) const;

 private:
  enum class Asking { Nothing, Note, Repeat, Exclude, End };
  /// A change that a key requests.
  struct Deed {
    std::string what;
    std::function<void()> store;  ///< commits it
    std::function<void()> then;   ///< confirms it
  };

  void read(char byte);
  void carry_out(const Deed& deed);
  void command(char byte);
  void ask(Asking what, const std::string& prompt);
  void enter();
  void note(const std::string& words);
  void repeat(const std::string& reason);
  void show_at_the_end(const OpenUnit& trial);
  void exclude(const std::string& reason);
  void reveal();
  void say(const std::string& line);
  void keep(std::string what, std::function<void()> store, std::function<void()> then);
  std::string describe(const OpenUnit& unit) const;
  std::string describe_cells(const PlannedTrial& trial) const;
  std::string describe(const TimingVerdict& verdict) const;
  std::string left() const;
  std::string describe_person(std::int64_t now_ns) const;
  std::string describe_course() const;
  std::vector<std::string> alarms(std::int64_t now_ns, double disk_mb) const;
  bool looks(std::int64_t now_ns) const;
  double on_page_s(std::int64_t now_ns) const;

  const Protocol& protocol_;
  Store& store_;
  std::filesystem::path database_;
  Idle idle_;
  std::vector<double> showing_s_;

  std::mutex acting_;         ///< held while a key is handled; locked before mutex_
  mutable std::mutex mutex_;  ///< guards all members below
  const OpenSession* session_ = nullptr;
  std::optional<OpenUnit> unit_;  ///< under way
  bool unit_done_ = false;
  std::optional<OpenUnit> last_trial_;  ///< finished
  std::size_t done_ = 0;                ///< units of this session done in this run
  bool paused_ = false, ended_ = false, repeat_ = false, revealed_ = false, reopened_ = false;
  Asking asking_ = Asking::Nothing;
  std::string prompt_, typed_;
  std::vector<std::string> lines_;
  std::optional<Deed> deed_;  ///< carried out by the thread that set it
  std::vector<std::string> warnings_;
  std::optional<Trouble> trouble_;  ///< the reason of the current pause
  std::optional<Ending> ending_;
  std::vector<TimingVerdict> verdicts_;  ///< of last_trial_
  std::int64_t page_since_ns_ = 0;       ///< steady clock: when the step began or its stimulus ended

  /// Timing of the current stimulus so far.
  struct Course {
    std::int64_t frames = 0, late = 0;
    std::int64_t first_scheduled_ns = 0, first_shown_ns = 0, last_scheduled_ns = 0, last_shown_ns = 0;
    double worst_late_ms = 0;
    std::string strip;  ///< one sign per half second
    std::int64_t strip_scheduled_ns = 0, strip_shown_ns = 0, strip_frames = 0;
  };
  Course course_;
};

/// '.' if the rate over some frames is within 2 % of the schedule's, '+' if faster, '-' if slower by up to 20
/// %, '!' beyond.
char strip_sign(double shown_s, double scheduled_s);

}  // namespace study
