#pragma once
/// A headset as a display of stimuli, and its slots as the session's clock.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/headset/frame_loop.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/protocol/headset_rules.hpp"

namespace apps {

/// Shows a picture for as long as the schedule says, in every slot that the runtime gives; what it does while
/// the head moves is the rules' hold mode. Black is a slot without a picture. A session that the runtime
/// loses is made anew in place (FrameLoop). Destroy stimuli that drew on it first. All calls but an
/// onlooker's on the thread that made it.
class HeadsetDisplay final : public study::Display {
 public:
  /// Connects, waits until the headset is worn and has settled at its rate. base::Error for what is not
  /// there, a headset that nobody puts on, and one that does not take the rules' rate.
  explicit HeadsetDisplay(SlotDrive drive, const HeadsetChoice& choice = {},
                          const study::HeadsetRules& rules = {});

  std::string description() const override;
  /// C; D where the runtime's times do not convert, repeat or leave their grid.
  study::TimingGrade grade() const override;
  double refresh_hz() const override { return refresh_hz_; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Remembers it: it is drawn as late as it can be, from where the head will be when it comes on. The first
  /// of a presentation is also drawn now, to learn how long that takes.
  void render(study::Stimulus& stimulus) override;
  study::PresentTimes present(std::int64_t scheduled_ns, study::Clock& clock) override;
  /// Draws what is shown anew for each slot; Hold::State alone.
  void hold(std::int64_t until_ns, study::Clock& clock) override;
  void clear() override;

  /// When what is handed over now would be seen, on the runtime's clock, ns: that of the next slot, which
  /// goes on between slots where they have a thread of their own.
  std::int64_t now_ns() const { return loop_.now_ns(); }
  /// Waits until the next slot is the nearest to deadline_ns, or a later one.
  void turn_until(std::int64_t deadline_ns);
  /// Waits for the next slot, or a tenth of a second where none comes.
  void turn();

  /// To draw a page into, of the size that was chosen; ask again for each drawing.
  const sim::Offscreen& page() { return loop_.page(); }
  /// Shows the page as it was drawn, before whatever else is seen, until hide_page().
  void show_page(const HeadsetPage& page) { loop_.show_page(page); }
  void hide_page() { loop_.hide_page(); }

  /// What the slots brought in since the last call, of those that are over; the oldest go where there are
  /// many.
  std::vector<HeadsetRecord> take_records();
  /// The same, after the next slot; nothing where none came for a tenth of a second.
  std::vector<HeadsetRecord> next_records();
  /// As take_records(), for whoever keeps the record: what one takes the other still gets.
  std::vector<HeadsetRecord> take_for_record();
  SessionFacts session() const { return loop_.session(); }
  const study::HeadsetRules& rules() const { return rules_; }
  LoopFacts facts() const { return loop_.facts(); }

  /// See FrameLoop.
  sim::GlContext admit_onlooker() { return loop_.admit_onlooker(); }
  SeenNow look() { return loop_.look(); }
  void look_away() { loop_.look_away(); }

  /// Whether the participant sees and can answer.
  bool focused() const { return facts().state == HeadsetState::Focused && !new_session_; }
  /// Why, since the last call, a picture that was on could not be seen, or the world or the rate changed
  /// under it; none: all is well.
  std::optional<study::CutCause> take_spoilt();
  /// What happened to the session since the last call, for the log: lost, and made anew.
  std::vector<std::string> take_news() { return std::exchange(news_, {}); }

 private:
  std::int64_t lead_ns() const;
  void heed();
  std::optional<double> met_hz() const;
  void settle_new_session();
  void share_records();
  void check_time_stands_still();
  void await(const std::function<bool()>& ready, const char* problem, const char* mend);
  std::optional<HeldViews> draw(std::int64_t at_ns);

  study::HeadsetRules rules_;
  FrameLoop loop_;
  study::Stimulus* pending_ = nullptr;
  double refresh_hz_ = 0;
  std::int64_t draw_ns_ = 0;  ///< that a picture takes lately; 0: none was drawn, or slots are the caller's
  std::vector<HeadsetRecord> for_pages_, for_record_;
  std::vector<std::string> news_;
  std::optional<study::CutCause> spoilt_;  ///< nothing more of the presentation is shown, for this cause
  bool slots_by_thread_;
  bool playing_ = false;      ///< a presentation is on
  bool new_session_ = false;  ///< it was made anew, and its rate has not settled yet
};

/// The time at which what is handed over now would be seen. A wait ends at the slot that is nearest to
/// its deadline, and takes that for the deadline itself.
class HeadsetClock final : public study::Clock {
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

}  // namespace apps
