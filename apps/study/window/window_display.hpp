#pragma once
/// The participant's window as a display of stimuli: drawn off-screen, shown by a swap that waits for the
/// screen.

#include <memory>
#include <string>

#include "apps/study/desk/preflight.hpp"
#include "apps/study/desk/refresh.hpp"
#include "apps/study/window/participant_window.hpp"
#include "libsim/render/offscreen.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// Its evidence is when frames were handed over (grade D): the screen does not say when it showed them. The
/// predicted time is the screen's next beat, as measured before the trial. Destroy stimuli that drew on it
/// first.
class WindowDisplay final : public study::Display {
 public:
  /// Measures the refresh for some two seconds on a black window. The session's clock must be real.
  explicit WindowDisplay(std::shared_ptr<ParticipantWindow> window);

  std::string description() const override;
  study::TimingGrade grade() const override { return study::TimingGrade::CpuSubmit; }
  /// 0 where swaps do not wait for the screen.
  double refresh_hz() const override { return refresh_.nominal_hz; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Takes the screen's beat anew, on a black window: some ten periods. Its drift since the start is then
  /// nothing to a trial. At once where swaps do not wait.
  void find_beat();
  /// Draws off-screen, copies to the window's back buffer and waits until the device has finished: present()
  /// is then a swap alone, and a slow picture shows as a late one.
  void render(study::Stimulus& stimulus) override;
  /// gpu_done is when the picture lay ready, which is before it was submitted.
  study::PresentTimes present(std::int64_t scheduled_ns, study::Clock& clock) override;

  ScreenFacts facts() const;

 private:
  std::vector<std::int64_t> swap_black(int swaps);

  std::shared_ptr<ParticipantWindow> window_;
  study::RealClock clock_;
  sim::Offscreen picture_;
  Monitor monitor_;
  std::string device_;  ///< of OpenGL
  MeasuredRefresh refresh_;
  std::int64_t ready_ns_ = -1;
};

}  // namespace apps
