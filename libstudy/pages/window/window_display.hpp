#pragma once
/// The participant's window as a display of stimuli: draws off-screen, shows by a swap that waits for the
/// screen.

#include <memory>
#include <string>

#include "libsim/render/offscreen.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/console/preflight.hpp"
#include "libstudy/console/refresh.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/pages/window/participant_window.hpp"

namespace study {

/// Its timing evidence is the submission (grade D): the screen does not report when it showed a frame. The
/// predicted time is the screen's next beat (refresh.hpp), as measured before the trial. Destroy stimuli that
/// drew on it first.
class WindowDisplay final : public Display {
 public:
  /// Measures the refresh for about two seconds on a black window. The session's clock must be real.
  explicit WindowDisplay(std::shared_ptr<ParticipantWindow> window);

  std::string description() const override;
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  /// 0 if swaps do not wait for the screen.
  double refresh_hz() const override { return refresh_.nominal_hz; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Measures the screen's beat again on a black window for about ten periods, so that its drift since the
  /// start does not matter to a trial. Returns at once if swaps do not wait.
  void find_beat();
  /// Draws off-screen, copies to the window's back buffer and waits until the device has finished, so that
  /// present() is only a swap and a slow picture counts as late.
  void render(Stimulus& stimulus) override;
  /// gpu_done is the time when the picture was ready, before its submission.
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override;

  ScreenFacts facts() const;

 private:
  std::vector<std::int64_t> swap_black(int swaps);

  std::shared_ptr<ParticipantWindow> window_;
  RealClock clock_;
  sim::Offscreen picture_;
  Monitor monitor_;
  std::string device_;  ///< of OpenGL
  MeasuredRefresh refresh_;
  std::int64_t ready_ns_ = -1;
};

}  // namespace study
