#pragma once
/// A stimulus and a display that show nothing, for sessions without a fluid and without a screen.

#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"

namespace study {

/// A stimulus without content: reports only the simulated time of each content step.
class NullStimulus final : public Stimulus {
 public:
  /// content_step_s: simulated time of one step, s.
  explicit NullStimulus(double content_step_s) : content_step_s_(content_step_s) {}
  std::string description() const override { return "none"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t) override {}
  FrameFacts prepare(std::int64_t step) override {
    FrameFacts facts;
    facts.simulation_time_s = static_cast<double>(step) * content_step_s_;
    return facts;
  }
  void draw(const Canvas&) override {}

 private:
  double content_step_s_;
};

/// Waits until the scheduled time of each frame and draws nothing.
class NullDisplay final : public Display {
 public:
  std::string description() const override { return "none"; }
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  void render(Stimulus&) override {}
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override {
    clock.wait_until(scheduled_ns);
    PresentTimes times;
    times.submitted_ns = clock.now_ns();
    return times;
  }
};

}  // namespace study
