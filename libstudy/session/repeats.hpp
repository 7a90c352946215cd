#pragma once
/// How often a cut trial is shown again, and how long the screen is black before the next showing. The rules
/// are the same for every display and every cause of a cut, except that a cut for lack of gaze also waits
/// until the eye tracker sees the eyes. Nothing begins at another refresh rate than the protocol's. The black
/// screen keeps repeated cuts from making a stimulus flash.

#include "libstudy/session/running.hpp"

namespace study {

/// Largest number of repeats of a trial without a pause: one more cut pauses the session.
inline constexpr int most_repeats = 3;
/// Shortest black screen between a cut and the next showing, s.
inline constexpr double black_after_cut_s = 1;
/// Time within which an eye tracker must give a valid sample before the first trial, after a pause and after
/// a cut for lack of gaze, s. Otherwise the session pauses.
inline constexpr double eyes_within_s = 3;
/// Time within which the display must have a known refresh rate, the protocol's where it names one, before
/// each showing of a trial, s. Otherwise the session pauses. The display asks for the rate meanwhile.
inline constexpr double rate_within_s = 5;

/// Repeats cut trials and pauses by the rules of this file, in one running session. Each pause reports the
/// problem (SessionHooks::trouble). It lasts until the experimenter continues or, if that hook is missing or
/// returns false, until the participant continues. With a simulated participant, base::Error instead of a
/// pause; the session stays open.
class Repeats {
 public:
  explicit Repeats(const Running& run) : run_(run) {}

  /// Call once per trial, before its first showing.
  void begin_trial();
  /// Call after a cut is stored. Waits until the trial may be shown again.
  void after_cut(CutCause cause);
  /// Pauses because the present refresh rate cannot show a trial of the session. Returns once the session
  /// goes on; the rate may be another one then.
  void wait_for_rate();

 private:
  void require_rate();
  void require_eyes();
  void pause(const Trouble& trouble);

  const Running& run_;
  int cuts_ = 0;            ///< cuts of the trial since its start, or since the pause that they caused
  bool eyes_seen_ = false;  ///< false: the eye tracker must be checked, as after a pause or a cut for gaze
};

}  // namespace study
