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

/// Hides method, frame rate and all hints at them until the experimenter reveals them; the database logs when
/// they are revealed or hidden. The session's thread and the key thread call this class. The key thread
/// stores a requested change in the database at once, even during a trial, and then confirms it. If storing
/// fails, the console says "NOT KEPT" and the session goes on.
class Console {
 public:
  /// Seconds since the participant's last key, button or movement of the mouse; none: not known.
  using Idle = std::function<std::optional<double>()>;

  /// showing_s: duration of one showing of each cell, s, for the estimate of the time left (expected_s());
  /// empty: the planned durations.
  Console(const Protocol& protocol, Store& store, std::filesystem::path database, Idle idle = {},
          std::vector<double> showing_s = {});
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Called on the session's thread: begin() at the start of a session, the others as its SessionHooks. After
  /// the experimenter repeats the current trial, request() returns CutCause::Experimenter once.
  void begin(const OpenSession& session);
  void begins(const OpenUnit& unit);
  void shown(const FrameRecord& frame);
  void done(const UnitDone& unit);
  void ends(const Ending& ending);
  Request request();
  /// Pauses the session until key p; shows an alarm with the reason and the remedy.
  void trouble(const Trouble& trouble);
  /// Adds an alarm for the rest of this session, such as a problem of the station.
  void warn(const std::string& alarm);
  /// Returns true, once, if the experimenter reopened trials that the session had already shown. After false
  /// the session is over, and keys do nothing until the next session begins.
  bool take_reopened();

  /// Called on the key thread: handles one typed byte.
  void key(char byte);
  /// Returns the messages since the last call, one per line.
  std::vector<std::string> take_lines();
  /// The content of the screen without the messages (ConsoleView::said). now_ns: time of the steady clock.
  ConsoleView view(std::int64_t now_ns) const;

 private:
  enum class Asking { Nothing, Note, Repeat, Exclude, End };
  /// A change of the database that a key requests.
  struct Deed {
    std::string what;
    std::function<void()> store;  ///< commits the change
    std::function<void()> then;   ///< confirms the change
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
  std::optional<OpenUnit> unit_;  ///< the unit that began last
  bool unit_done_ = false;
  std::optional<OpenUnit> last_trial_;  ///< the trial that finished last
  std::size_t done_ = 0;                ///< number of units done since begin()
  bool paused_ = false, ended_ = false, repeat_ = false, revealed_ = false, reopened_ = false;
  Asking asking_ = Asking::Nothing;
  std::string prompt_, typed_;
  std::vector<std::string> lines_;
  std::optional<Deed> deed_;  ///< a change that the key thread will carry out next
  std::vector<std::string> warnings_;
  std::optional<Trouble> trouble_;  ///< the reason of the current pause
  std::optional<Ending> ending_;
  std::vector<TimingVerdict> verdicts_;  ///< verdicts on last_trial_
  std::int64_t page_since_ns_ = 0;       ///< steady-clock time of the latest step start, frame or early end

  /// Timing of the current stimulus so far.
  struct Course {
    std::int64_t frames = 0, late = 0;
    std::int64_t first_scheduled_ns = 0, first_shown_ns = 0, last_scheduled_ns = 0, last_shown_ns = 0;
    double worst_late_ms = 0;
    std::string strip;  ///< one strip_sign() per half second
    std::int64_t strip_scheduled_ns = 0, strip_shown_ns = 0;
  };
  Course course_;
};

/// Compares the realised frame rate with the scheduled rate: '.' within 2 %, '+' up to 20 % faster, '-' up to
/// 20 % slower, '!' beyond. Arguments: realised and scheduled duration of the same frames, s.
char strip_sign(double shown_s, double scheduled_s);

}  // namespace study
