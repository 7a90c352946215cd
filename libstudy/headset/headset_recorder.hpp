#pragma once
/// Provides a headset's gaze and slots to the session's record, and its gaze to the fluid.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/display/gaze.hpp"
#include "libstudy/display/headset.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/headset/outside_eyes.hpp"
#include "libstudy/stimulus/framing.hpp"

namespace study {

/// Converts the display's records to gaze samples and slots; the display must outlive the recorder. The gaze
/// is that of the eye tracker, or the head's direction as a substitute. Tracker data are used only between
/// start() and stop(), the time for which the participant consents. Otherwise ray() gives the head's
/// direction.
///
/// Makes one sample for each sample time that the runtime reports, or one per slot if it reports no times. A
/// sample of lost eyes without a new reported time has no device time. Its time is the slot's time minus the
/// largest lag reported so far, but not before the last sample.
///
/// With an eye tracker outside OpenXR, makes one sample for each sample of that tracker instead.
class HeadsetRecorder final : public GazeSource, public SlotSource {
 public:
  /// origin: Head, or Tracker for a display made with HeadsetChoice::eye_gaze.
  HeadsetRecorder(HeadsetDisplay& display, GazeOrigin origin) : display_(display), origin_(origin) {}
  /// Takes the gaze from an eye tracker outside OpenXR.
  HeadsetRecorder(HeadsetDisplay& display, std::shared_ptr<EyeTracker> outside)
      : display_(display), origin_(GazeOrigin::Tracker), outside_(std::move(outside)) {}

  GazeOrigin origin() const override { return origin_; }
  void start() override;
  std::vector<GazeSample> take() override;
  void stop() override;
  std::optional<TrackerClock> clock() override;
  std::vector<TrackerClock> take_clocks() override;
  std::vector<std::string> take_gaze_news() override;
  std::string trouble() override { return outside_ ? outside_->trouble() : ""; }

  HeadsetFacts facts() const override;
  void start_slots(bool with_heads) override;
  std::vector<SlotRecord> take_slots() override;
  void stop_slots() override { slots_.clear(); }
  std::optional<double> ipd_mm() override;
  std::vector<std::string> take_news() override { return display_.take_news(); }
  std::vector<HeadsetFacts> take_facts() override;

  /// Ray of the gaze, or of the head, in the newest finished slot; in metres of the scene. None if unknown.
  std::optional<RoomRay> ray();

 private:
  void drain();
  void add_gaze(const HeadsetRecord& record);

  HeadsetDisplay& display_;
  GazeOrigin origin_;
  std::shared_ptr<EyeTracker> outside_;  ///< null: the gaze is the runtime's
  OutsideEyes eyes_;
  bool allowed_ = false, with_heads_ = false;
  std::vector<GazeSample> gaze_;
  std::vector<SlotRecord> slots_;
  std::optional<HeadsetRecord> newest_;
  /// Newest sample time that the runtime reported; largest lag of such a time behind its slot's time.
  std::int64_t last_reported_ns_ = 0, lag_ns_ = 0;
  /// Time of the newest sample that was stored, whether the runtime reported it or it was derived from the
  /// slot.
  std::int64_t last_ns_ = 0;
};

/// The gaze sample of a slot; its ray is in the head's frame. Not valid if the orientation of the head is not
/// valid or, for a tracker, that of the eyes. The sample's point is in the picture shown to the left eye;
/// none without a picture, or if the gaze points behind the picture's eye.
GazeSample gaze_of(const HeadsetRecord& record, GazeOrigin origin);

/// Distance between the eyes, mm; none if their poses are not valid or their positions are equal.
std::optional<double> ipd_of(const EyeViews& views);

}  // namespace study
