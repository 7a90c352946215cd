#pragma once
/// The experimenter's console: how the session that is running goes, and keys that steer it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/desk/console_screen.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/store.hpp"

namespace apps {

/// Method, frame rate and all that gives them away are hidden until they are revealed, which is logged. Two
/// threads use it: the session's, and the one that reads the keys. What a key asks to be kept is committed by
/// the latter at once, also while a trial is shown, and said to be done after that; where it fails, "NOT
/// KEPT" is said and the session goes on.
class Console {
 public:
  /// Seconds since the participant's last key, button or movement of the mouse; none: not known.
  using Idle = std::function<std::optional<double>()>;

  /// showing_s: see expected_s(); empty: showings take as long as planned.
  Console(const study::Protocol& protocol, study::Store& store, std::filesystem::path database,
          Idle idle = {}, std::vector<double> showing_s = {});
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// The session's thread: a session begins; then its hooks. wish() is a cut once.
  void begin(const study::OpenSession& session);
  void begins(const study::OpenUnit& unit);
  void shown(const study::FrameRecord& frame);
  void done(const study::UnitDone& unit);
  void ends(const study::Ending& ending);
  study::Wish wish();
  /// The session pauses until p: an alarm says why, and what to do.
  void trouble(const study::Trouble& trouble);
  /// An alarm that stays for this session, such as what the station lacks.
  void warn(const std::string& alarm);
  /// Whether trials were opened again that this session is already past; forgets it. If not, the session is
  /// over and keys do nothing until the next begins.
  bool take_reopened();

  /// The thread of the keys: what was typed, byte by byte.
  void key(char byte);
  /// Lines to be written since the last call.
  std::vector<std::string> take_lines();
  /// What the screen shows, without `said`; now_ns: of the steady clock.
  ConsoleView view(std::int64_t now_ns) const;

 private:
  enum class Asking { Nothing, Note, Repeat, Exclude, End };
  /// What a key asks to be kept.
  struct Deed {
    std::string what;
    std::function<void()> store;  ///< commits it
    std::function<void()> then;   ///< says so
  };

  void read(char byte);
  void carry_out(const Deed& deed);
  void command(char byte);
  void ask(Asking what, const std::string& prompt);
  void enter();
  void note(const std::string& words);
  void repeat(const std::string& reason);
  void show_at_the_end(const study::OpenUnit& trial);
  void exclude(const std::string& reason);
  void reveal();
  void say(const std::string& line);
  void keep(std::string what, std::function<void()> store, std::function<void()> then);
  std::string describe(const study::OpenUnit& unit) const;
  std::string describe_cells(const study::PlannedTrial& trial) const;
  std::string describe(const study::TimingVerdict& verdict) const;
  std::string left() const;
  std::string describe_person(std::int64_t now_ns) const;
  std::string describe_course() const;
  std::vector<std::string> alarms(std::int64_t now_ns, double disk_mb) const;
  bool looks(std::int64_t now_ns) const;
  double on_page_s(std::int64_t now_ns) const;

  const study::Protocol& protocol_;
  study::Store& store_;
  std::filesystem::path database_;
  Idle idle_;
  std::vector<double> showing_s_;

  std::mutex acting_;         ///< while a key has its effect; taken before mutex_
  mutable std::mutex mutex_;  ///< of all that follows
  const study::OpenSession* session_ = nullptr;
  std::optional<study::OpenUnit> unit_;  ///< under way
  bool unit_done_ = false;
  std::optional<study::OpenUnit> last_trial_;  ///< finished
  std::size_t done_ = 0;                       ///< units of this session, in this run
  bool paused_ = false, ended_ = false, repeat_ = false, revealed_ = false, reopened_ = false;
  Asking asking_ = Asking::Nothing;
  std::string prompt_, typed_;
  std::vector<std::string> lines_;
  std::optional<Deed> deed_;  ///< to be carried out by the thread that set it
  std::vector<std::string> warnings_;
  std::optional<study::Trouble> trouble_;  ///< for which the session pauses
  std::optional<study::Ending> ending_;
  std::vector<study::TimingVerdict> verdicts_;  ///< of last_trial_
  std::int64_t page_since_ns_ = 0;              ///< steady clock: the step began, or its stimulus ended

  /// How the present stimulus goes.
  struct Course {
    std::int64_t frames = 0, late = 0;
    std::int64_t first_scheduled_ns = 0, first_shown_ns = 0, last_scheduled_ns = 0, last_shown_ns = 0;
    double worst_late_ms = 0;
    std::string strip;  ///< a sign for each half second
    std::int64_t strip_scheduled_ns = 0, strip_shown_ns = 0, strip_frames = 0;
  };
  Course course_;
};

/// '.' where the rate over some frames is within 2 % of the schedule's, '+' faster, '-' slower by up to 20 %,
/// '!' beyond.
char strip_sign(double shown_s, double scheduled_s);

}  // namespace apps
