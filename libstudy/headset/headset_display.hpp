#pragma once
/// A headset as a display of stimuli, and its slots as the session's clock.

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

/// Shows a picture for as long as the schedule says, in every slot that the runtime gives; the rules' hold
/// mode says how it behaves while the head moves. Black is a slot without a picture. A session that the
/// runtime loses is made again (FrameLoop). First destroy stimuli that drew on it. All calls except the
/// onlooker's come from the thread that made it.
class HeadsetDisplay final : public Display {
 public:
  /// Connects, then waits until the headset is worn and its rate has settled. base::Error for missing parts,
  /// a headset that nobody puts on, and one that does not take the rules' rate.
  explicit HeadsetDisplay(SlotDrive drive, const HeadsetChoice& choice = {}, const HeadsetRules& rules = {});

  std::string description() const override;
  /// C; D if the runtime's times do not convert, repeat or leave their grid.
  TimingGrade grade() const override;
  double refresh_hz() const override { return refresh_hz_; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Remembers the stimulus: it is drawn as late as possible, from where the head will be when it comes on.
  /// The first one of a presentation is also drawn now, to measure how long that takes.
  void render(Stimulus& stimulus) override;
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override;
  /// Draws the shown picture again for each slot; Hold::State only.
  void hold(std::int64_t until_ns, Clock& clock) override;
  void clear() override;

  /// When a picture posted now would be seen, on the runtime's clock, ns: the time of the next slot. If a
  /// thread runs the slots, it also advances between them.
  std::int64_t now_ns() const { return loop_.now_ns(); }
  /// Waits until the next slot is the nearest one to deadline_ns, or a later one.
  void turn_until(std::int64_t deadline_ns);
  /// Waits for the next slot, a tenth of a second at most.
  void turn();

  /// The canvas of the page, of the chosen size; call it again for each drawing.
  const sim::Offscreen& page() { return loop_.page(); }
  /// Shows the page in front of everything else until hide_page().
  void show_page(const HeadsetPage& page) { loop_.show_page(page); }
  void hide_page() { loop_.hide_page(); }

  /// Records of finished slots since the last call; too many drop the oldest.
  std::vector<HeadsetRecord> take_records();
  /// The same after the next slot; empty if none came for a tenth of a second.
  std::vector<HeadsetRecord> next_records();
  /// As take_records(), for the code that records the session: each of the two gets all records.
  std::vector<HeadsetRecord> take_for_record();
  SessionFacts session() const { return loop_.session(); }
  const HeadsetRules& rules() const { return rules_; }
  LoopFacts facts() const { return loop_.facts(); }

  /// See FrameLoop.
  sim::GlContext admit_onlooker() { return loop_.admit_onlooker(); }
  SeenNow look() { return loop_.look(); }
  void look_away() { loop_.look_away(); }

  /// True if the participant sees and can answer.
  bool focused() const { return facts().state == HeadsetState::Focused && !new_session_; }
  /// Why, since the last call, a picture that was on could not be seen, or that the world or the rate
  /// changed; none if all is well.
  std::optional<CutCause> take_spoilt();
  /// Log lines since the last call: the session was lost, or made again.
  std::vector<std::string> take_news() { return std::exchange(news_, {}); }

 private:
  std::int64_t lead_ns() const;
  void poll_requests();
  std::optional<double> met_hz() const;
  void settle_new_session();
  void share_records();
  void check_time_stands_still();
  void await(const std::function<bool()>& ready, const char* problem, const char* mend);
  std::optional<HeldViews> draw(std::int64_t at_ns);

  HeadsetRules rules_;
  FrameLoop loop_;
  Stimulus* pending_ = nullptr;
  double refresh_hz_ = 0;
  std::int64_t draw_ns_ = 0;  ///< recent drawing time; 0: nothing drawn, or slots by the caller
  std::vector<HeadsetRecord> for_pages_, for_record_;
  std::vector<std::string> news_;
  std::optional<CutCause> spoilt_;  ///< why nothing more of the presentation is shown
  bool slots_by_thread_;
  bool playing_ = false;      ///< a presentation is on
  bool new_session_ = false;  ///< the session was made again, and its rate has not settled yet
};

/// The time at which a picture posted now would be seen. A wait ends at the slot nearest to its deadline, and
/// the clock then shows at least the deadline.
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
