#pragma once
/// A headset as a source of gaze and slots for a session's record and for the fluid.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/display/gaze.hpp"
#include "libstudy/display/headset.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/stimulus/framing.hpp"

namespace study {

/// Takes the records of the display while a presentation is on; the display must outlive it. The gaze is that
/// of the eye tracker, or the head's direction as a substitute. Tracker data are used only between start()
/// and stop(), which enclose what the participant allows; otherwise the fluid follows the head.
///
/// Makes one sample for each sample time that the runtime reports, and one per slot if it reports none.
/// Samples of lost eyes have no reported time: they lie before their slots by the largest lag reported so
/// far, but never before the last sample, so that samples stay in order.
class HeadsetRecorder final : public GazeSource, public SlotSource {
 public:
  /// origin: Tracker, for a display that asked for one, or Head.
  HeadsetRecorder(HeadsetDisplay& display, GazeOrigin origin) : display_(display), origin_(origin) {}

  GazeOrigin origin() const override { return origin_; }
  void start() override;
  std::vector<GazeSample> take() override;
  void stop() override;

  HeadsetFacts facts() const override;
  void start_slots(bool with_heads) override;
  std::vector<SlotRecord> take_slots() override;
  void stop_slots() override { slots_.clear(); }
  std::optional<double> ipd_mm() override;
  std::vector<std::string> take_news() override { return display_.take_news(); }

  /// Ray of the gaze, or of the head, in the newest finished slot, in the scene's metres; none if unknown.
  std::optional<RoomRay> ray();

 private:
  void drain();
  void add_gaze(const HeadsetRecord& record);

  HeadsetDisplay& display_;
  GazeOrigin origin_;
  bool allowed_ = false, with_heads_ = false;
  std::vector<GazeSample> gaze_;
  std::vector<SlotRecord> slots_;
  std::optional<HeadsetRecord> newest_;
  std::int64_t last_reported_ns_ = 0, lag_ns_ = 0;  ///< last reported time; largest lag before its slot
  std::int64_t last_ns_ = 0;                        ///< time of the last sample
};

/// The gaze sample of a slot, in the head's frame; not valid if the eyes, or the head's orientation, are not.
/// Its point is on the left eye's picture that was on; none in black.
GazeSample gaze_of(const HeadsetRecord& record, GazeOrigin origin);

/// Distance between the eyes, mm; none if they are not valid.
std::optional<double> ipd_of(const EyeViews& views);

}  // namespace study
