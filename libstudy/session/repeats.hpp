#pragma once
/// How often a cut trial is shown again, and what precedes the next showing. One rule for every display and
/// every cause of a cut, so that no participant sees a stimulus flash.

#include "libstudy/session/running.hpp"

namespace study {

/// Number of repeats of a trial. After one more cut the session pauses.
inline constexpr int most_repeats = 3;
/// Least time of black screen between a cut and the next showing, s.
inline constexpr double black_after_cut_s = 1;
/// An eye tracker must see the eyes within this time before the first trial, after a pause and after a cut
/// for lack of gaze, s. Otherwise the session pauses.
inline constexpr double eyes_within_s = 3;

/// Applies the rule in one running session. Each pause reports the problem (SessionHooks::trouble) and lasts
/// until the experimenter or, without a console, the participant continues. For a simulated participant a
/// pause is a base::Error: the session stays open.
class Repeats {
 public:
  explicit Repeats(const Running& run) : run_(run) {}

  /// Call before the first showing of a trial in this run of the session.
  void begin_trial();
  /// Call after a cut is stored. Returns once the trial may be shown again.
  void after_cut(CutCause cause);

 private:
  void require_eyes();
  void pause(const Trouble& trouble);

  const Running& run_;
  int cuts_ = 0;            ///< of the trial, since its start or the last pause
  bool eyes_seen_ = false;  ///< since the session began or paused
};

}  // namespace study
