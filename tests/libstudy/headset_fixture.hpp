#pragma once
/// Data of a headset, for tests.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/session/session.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study::test {

inline HeadsetFacts headset_facts() {
  HeadsetFacts facts;
  facts.runtime = "a runtime";
  facts.runtime_version = "1.2.3";
  facts.headset = "a headset";
  facts.eyes = {EyeFacts{2064, 2208, -52, 42, 46, -50}, EyeFacts{2060, 2200, -42, 52, 46, -50}};
  facts.format = "SRGB8_ALPHA8";
  facts.blend = "opaque";
  facts.refresh_told_hz = 90;
  facts.refresh_measured_hz = 89.5;
  facts.times_convert = facts.position_tracking = facts.eye_tracking = true;
  return facts;
}

/// A pose; each `number` gives a different one.
inline HeadPose head_at(double number) {
  return {{number, 1.5, -0.25}, {0, 0.6, 0, 0.8}, true, true, true, false};
}

inline SlotRecord slot_at(std::int64_t predicted_ns, double ipd_mm = 63, double head = 0.5) {
  return {predicted_ns, 11'111'111, true, head_at(head), ipd_mm};
}

/// A gaze ray ahead and to the right.
inline GazeSample ray_sample(std::int64_t sampled_ns, double x = 0.6) {
  return {sampled_ns, sampled_ns, true, GazePoint{0.25, 0.5}, false, GazeRay{{0, 0, 0.01}, {x, 0, -0.8}}};
}

/// Delivers a slot for each 10 ms of the clock. `ipd_of` maps a time in ns to the distance between the eyes
/// in mm.
class SlotEvery10ms final : public SlotSource {
 public:
  explicit SlotEvery10ms(const Clock& clock) : clock_(clock) {}
  HeadsetFacts facts() const override { return headset_facts(); }
  void start_slots(bool with_heads) override {
    heads_ = with_heads;
    next_ns_ = clock_.now_ns();
  }
  std::vector<SlotRecord> take_slots() override {
    std::vector<SlotRecord> out;
    for (; next_ns_ <= clock_.now_ns(); next_ns_ += 10'000'000) {
      out.push_back(slot_at(next_ns_, ipd_of ? ipd_of(next_ns_) : 63));
      if (!heads_) out.back().head.reset();
    }
    return out;
  }
  void stop_slots() override {}
  std::optional<double> ipd_mm() override { return ipd_of ? ipd_of(clock_.now_ns()) : 63; }

  std::vector<std::string> take_news() override { return std::exchange(news, {}); }

  std::function<double(std::int64_t)> ipd_of;
  std::vector<std::string> news;

 private:
  const Clock& clock_;
  bool heads_ = false;
  std::int64_t next_ns_ = 0;
};

/// Adds everything that a headset delivers to presentation and session `id`.
inline void add_headset_rows(Store& store, std::int64_t id, double telling = 0.5) {
  store.add_headset(id, headset_facts());
  store.add_ipd(id, 7, 63);
  const GazeSample sample = ray_sample(5, telling);
  store.add_gaze(id, 0, GazeOrigin::Tracker, {&sample, 1});
  const ShownSlot slot{slot_at(6, 63, telling), 0};
  store.add_slots(id, 0, {&slot, 1});
  const ValidatedPoint point{8, 10, -10, 30, 29, telling, 0.25, 0.125};
  store.add_validation(id, {&point, 1}, true);
}

inline std::filesystem::path headset_study(const TemporaryFolder& folder, const std::string& name,
                                           const std::vector<Says>& people) {
  Store store(folder / name, sqlite::Open::Create);
  add_people(store, asking_protocol(), people);
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (people[i].gaze == 1) add_headset_rows(store, static_cast<std::int64_t>(i) + 1);
  }
  return folder / name;
}

}  // namespace study::test
