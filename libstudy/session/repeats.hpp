#pragma once
/// How often a trial is shown again, and what comes before the next showing. One rule for every display and
/// every cause of a cut, so that no participant sees a stimulus flash.

#include "libstudy/session/running.hpp"

namespace study {

/// A trial is shown again so often. After one more cut the session pauses.
inline constexpr int most_repeats = 3;
/// Between a cut and the next showing the display is black for at least so long, s.
inline constexpr double black_after_cut_s = 1;
/// An eye tracker must see the eyes within this time before the first trial, after a pause, and after a cut
/// for want of gaze, s. Otherwise the session pauses.
inline constexpr double eyes_within_s = 3;

/// Of one session while it is played. Each pause says what is wrong (SessionHooks::trouble) and lasts until
/// the experimenter or, without a console, the participant goes on. For a simulated participant a pause is a
/// base::Error: the session stays open.
class Repeats {
 public:
  explicit Repeats(const Running& run) : run_(run) {}

  /// Before the first showing of a trial in this session's play.
  void begin_trial();
  /// After a cut, which is in the store. Returns when the trial may be shown again.
  void after_cut(CutCause cause);

 private:
  void require_eyes();
  void pause(const Trouble& trouble);

  const Running& run_;
  int cuts_ = 0;            ///< of the trial, since somebody let it go on
  bool eyes_seen_ = false;  ///< since the session began or paused
};

}  // namespace study
