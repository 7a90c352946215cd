#pragma once
/// A headset as a display of stimuli, and a session clock that follows the headset's slots.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/headset/frame_loop.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Shows each picture in all slots (frames of the runtime) of its scheduled interval. HeadsetRules::hold says
/// how a picture follows head movements until the next picture. A slot without a picture is black. If the
/// runtime loses the session, FrameLoop makes a new session. Destroy stimuli that drew on the display before
/// the display. All calls except look() and look_away() come from the thread that made the display.
class HeadsetDisplay final : public Display {
 public:
  /// Connects, then waits until the headset is worn and its refresh rate has settled. base::Error if the
  /// OpenXR loader, the runtime or the headset is missing, if the headset is not put on, or if its refresh
  /// rate does not settle at the rate that the rules require. With SlotDrive::Caller, base::Error
  /// also if the runtime's time advances between calls.
  explicit HeadsetDisplay(SlotDrive drive, const HeadsetChoice& choice = {}, const HeadsetRules& rules = {});

  std::string description() const override;
  /// Grade C (onset times are predictions of the compositor). Grade D (only times of submission are known) if
  /// the runtime's predicted times do not convert to the session's clock, do not increase from slot to slot,
  /// or have steps that are no multiples of the period.
  TimingGrade grade() const override;
  double refresh_hz() const override { return refresh_hz_; }
  double measured_hz() const override;
  bool keeps_rate() const override { return met_hz().has_value(); }
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Stores the stimulus. present() draws it as late as possible, for the predicted head pose. With
  /// SlotDrive::Thread, the first frame of a showing is also drawn here, to measure the drawing time.
  void render(Stimulus& stimulus) override;
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override;
  /// With Hold::State, draws the shown content again for each slot, for the new head pose; otherwise does
  /// nothing.
  void hold(std::int64_t until_ns, Clock& clock) override;
  void clear() override;

  /// The time at which a picture posted now would be shown: the time of the next slot on the session's clock,
  /// ns. If a thread runs the slots, the time also advances between slots.
  std::int64_t now_ns() const { return loop_.now_ns(); }
  /// Waits until the next slot is the slot nearest to deadline_ns, or a later slot.
  void turn_until(std::int64_t deadline_ns);
  /// Runs a slot, or with SlotDrive::Thread waits for the next one, 0.1 s at most; then processes events.
  void turn();

  /// The canvas to draw the page into, of the size in HeadsetChoice. Call it for each drawing.
  const sim::Offscreen& page() { return loop_.page(); }
  /// Shows the page in front of everything else until hide_page().
  void show_page(const HeadsetPage& page) { loop_.show_page(page); }
  void hide_page() { loop_.hide_page(); }

  /// Records of finished slots since the last call. Beyond FrameLoop::most_records records, the older half of
  /// them is dropped.
  std::vector<HeadsetRecord> take_records();
  /// Calls turn(), then returns take_records().
  std::vector<HeadsetRecord> next_records();
  /// As take_records(), but for the code that records the session. Each of the two functions returns every
  /// record once.
  std::vector<HeadsetRecord> take_for_record();
  SessionFacts session() const { return loop_.session(); }
  const HeadsetRules& rules() const { return rules_; }
  LoopFacts facts() const { return loop_.facts(); }

  /// For an onlooker (a mirror) on another thread: an OpenGL context that shares the pictures, and the shown
  /// picture and page, which stay unchanged until the next look() or look_away().
  sim::GlContext admit_onlooker() { return loop_.admit_onlooker(); }
  SeenNow look() { return loop_.look(); }
  void look_away() { loop_.look_away(); }

  /// True if the participant sees pictures and can give input.
  bool focused() const;
  /// The cause noted since the last call for which the showing must be cut; none: no cause. Causes: the
  /// session or its focus was lost, the headset was taken off, a picture was not drawn, the poses of the eyes
  /// were unknown, the world's origin moved, or the refresh rate changed.
  std::optional<CutCause> take_spoilt();
  /// As take_spoilt(), but first turns up to 10 slots, all black, if the session's state may yet explain the
  /// cause: pictures are missing and the focus is lost also where the headset is taken off.
  std::optional<CutCause> take_explained();
  /// Lines for the log since the last call: the session was lost, a new session was made, or the refresh rate
  /// changed.
  std::vector<std::string> take_news() { return std::exchange(news_, {}); }
  /// The refresh rates that came into force since the last call, in order, and that of each new session. A
  /// rate that changed again before it was measured has only one of the two values.
  std::vector<HeadsetRate> take_rates() { return std::exchange(rates_, {}); }

 private:
  std::int64_t lead_ns() const;
  void poll_requests();
  std::optional<double> met_hz() const;
  void change_rate(double from_hz, double to_hz);
  void settle_rate();
  void share_records();
  void check_time_stands_still();
  void await(const std::function<bool()>& ready, const std::string& problem, const char* mend);
  std::optional<HeldViews> draw(std::int64_t at_ns);

  HeadsetRules rules_;
  FrameLoop loop_;
  Stimulus* pending_ = nullptr;  ///< stimulus of the last render(), which present() draws
  double refresh_hz_ = 0;
  std::int64_t draw_ns_ = 0;  ///< largest recent drawing time; 0: nothing drawn, or SlotDrive::Caller
  std::vector<HeadsetRecord> for_pages_, for_record_;
  std::vector<std::string> news_;
  std::vector<HeadsetRate> rates_;
  std::optional<HeadsetRate> unsettled_;  ///< the rate of the last change; none once it is measured
  std::optional<CutCause> spoilt_;        ///< why the rest of the showing is black
  bool slots_by_thread_;
  bool playing_ = false;      ///< a stimulus is being shown
  bool new_session_ = false;  ///< the session was lost, and the rate of a new one has not settled
};

/// The session's clock for a headset. Its time is the time at which a picture posted now would be shown. A
/// wait ends once the next slot is the slot nearest to the deadline; the clock's time is then at least the
/// deadline.
class HeadsetClock final : public Clock {
 public:
  explicit HeadsetClock(HeadsetDisplay& display) : display_(display) {}
  std::int64_t now_ns() const override { return std::max(display_.now_ns(), reached_ns_); }
  void wait_until(std::int64_t deadline_ns) override {
    display_.turn_until(deadline_ns);
    reached_ns_ = std::max(reached_ns_, deadline_ns);
  }

 private:
  HeadsetDisplay& display_;
  std::int64_t reached_ns_ = 0;
};

}  // namespace study
