#pragma once
/// A headset as a display of stimuli, and its slots as the session's clock.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/headset/headset_session.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// What a slot brought in.
struct HeadsetRecord {
  HeadsetSlot slot;
  EyeViews views;  ///< where the eyes will be at slot.predicted_ns
  HeadsetInput input;
};

/// Shows a picture for as long as the schedule says, in every slot that the runtime gives: an old picture
/// keeps the pose that it was drawn from (hold mode `image`), and black is a slot without a picture. All
/// slots are turned on the calling thread, so none come while a stimulus computes: for runtimes whose time
/// stands still meanwhile. Destroy stimuli that drew on it first.
class HeadsetDisplay final : public study::Display {
 public:
  /// Connects, turns slots until the headset is worn and the rate has settled. base::Error for what is not
  /// there, and for a headset that nobody puts on.
  explicit HeadsetDisplay(const HeadsetChoice& choice = {});

  std::string description() const override;
  /// C; D where the runtime's times do not convert, repeat or leave their grid.
  study::TimingGrade grade() const override;
  double refresh_hz() const override { return refresh_hz_; }
  double measured_hz() const override;
  std::int64_t first_onset(std::int64_t earliest_ns) const override;
  /// Only remembers it: it is drawn from the pose of the slot in which it comes on.
  void render(study::Stimulus& stimulus) override { pending_ = &stimulus; }
  study::PresentTimes present(std::int64_t scheduled_ns, study::Clock& clock) override;
  void clear() override;

  /// When what is handed over now would be seen: the next slot, on the runtime's clock, ns.
  std::int64_t next_ns() const { return last_ns_ + period_ns(); }
  /// Turns slots until the next one is the nearest to deadline_ns, or a later one.
  void turn_until(std::int64_t deadline_ns);

  /// To draw a page into, of the size that was chosen.
  const sim::Offscreen& page() const { return session_->page(); }
  /// Shows the page as it was drawn, before whatever else is seen, until hide_page().
  void show_page(const HeadsetPage& page) { page_ = page; }
  void hide_page() { page_.reset(); }

  /// What the slots brought in since the last call, of those that are over; the oldest go where there are
  /// many.
  std::vector<HeadsetRecord> take_records();
  /// The same, after the next slot.
  std::vector<HeadsetRecord> next_records();
  const HeadsetSession& session() const { return *session_; }

  /// Whether, since the last question, a picture that was on could not be seen, or the world or the rate
  /// changed under it. Answers after the headset is worn again.
  bool take_spoilt();

 private:
  std::int64_t period_ns() const;
  HeadsetSlot begin_slot();
  void end_slot(const HeadsetSlot& slot);
  void turn() { end_slot(begin_slot()); }
  void heed(const HeadsetEvent& event);
  void become_focused();
  void draw();

  sim::GlContext gl_;
  std::unique_ptr<HeadsetSession> session_;
  std::unique_ptr<sim::Offscreen> canvas_;  ///< both eyes beside each other
  study::Stimulus* pending_ = nullptr;
  std::optional<EyeViews> shown_;  ///< what the present pictures were drawn from; none: black
  std::optional<HeadsetPage> page_;
  std::vector<HeadsetRecord> records_;
  std::int64_t last_ns_ = 0;  ///< of the last slot
  double refresh_hz_ = 0;
  bool playing_ = false;  ///< a presentation is on
  bool spoilt_ = false;
};

/// The time of a headset's slots, which passes as they are turned. A wait ends at the slot that is nearest to
/// its deadline, and takes that for the deadline itself.
class HeadsetClock final : public study::Clock {
 public:
  explicit HeadsetClock(HeadsetDisplay& display) : display_(display) {}
  std::int64_t now_ns() const override { return std::max(display_.next_ns(), reached_ns_); }
  void wait_until(std::int64_t deadline_ns) override {
    display_.turn_until(deadline_ns);
    reached_ns_ = std::max(reached_ns_, deadline_ns);
  }

 private:
  HeadsetDisplay& display_;
  std::int64_t reached_ns_ = 0;
};

}  // namespace apps
