#pragma once
/// A headset as a session records it, and as its fluid follows it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/framing.hpp"
#include "apps/common/headset/headset_display.hpp"
#include "libstudy/display/gaze.hpp"
#include "libstudy/display/headset.hpp"

namespace apps {

/// Takes the records of the display while a presentation is on; outlived by it. As a source of gaze it is the
/// eye tracker, or the direction of the head where that stands in. Of a tracker nothing is used before
/// start() and after stop(), which enclose what the participant allows: the fluid then follows the head.
///
/// A sample is taken for each time that the runtime tells, and for each slot where it tells none. Those of
/// eyes that are lost, for which no time is told, lie before their slots by the greatest age that was told,
/// and never before the last sample: so they stand in order with those that follow.
class HeadsetRecorder final : public study::GazeSource, public study::SlotSource {
 public:
  /// origin: Tracker, for a display that asked for one, or Head.
  HeadsetRecorder(HeadsetDisplay& display, study::GazeOrigin origin) : display_(display), origin_(origin) {}

  study::GazeOrigin origin() const override { return origin_; }
  void start() override;
  std::vector<study::GazeSample> take() override;
  void stop() override;

  study::HeadsetFacts facts() const override;
  void start_slots(bool with_heads) override;
  std::vector<study::SlotRecord> take_slots() override;
  void stop_slots() override { slots_.clear(); }
  std::optional<double> ipd_mm() override;
  std::vector<std::string> take_news() override { return display_.take_news(); }

  /// Where one looks, or the head, in the newest slot that is over, in the scene's metres; none: not known.
  std::optional<RoomRay> ray();

 private:
  void drain();
  void add_gaze(const HeadsetRecord& record);

  HeadsetDisplay& display_;
  study::GazeOrigin origin_;
  bool allowed_ = false, with_heads_ = false;
  std::vector<study::GazeSample> gaze_;
  std::vector<study::SlotRecord> slots_;
  std::optional<HeadsetRecord> newest_;
  std::int64_t last_told_ns_ = 0, lag_ns_ = 0;  ///< the last time that was told; most before its slot
  std::int64_t last_ns_ = 0;                    ///< of the last sample
};

/// One sample as a slot brought it in, in the head's frame; nothing of it is valid where the eyes, or the
/// head's turn, are not. Its point is on the left eye's picture that was on; none in black.
study::GazeSample gaze_of(const HeadsetRecord& record, study::GazeOrigin origin);

/// Between the eyes' places, mm; none where they are not valid.
std::optional<double> ipd_of(const EyeViews& views);

}  // namespace apps
