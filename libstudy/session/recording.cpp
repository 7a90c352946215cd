#include "libstudy/session/recording.hpp"

#include <algorithm>
#include <cmath>

namespace study {

namespace {

// Interval between two looks at a condition, s.
constexpr double look_again_s = 0.02;

bool allowed(const Running& run) { return run.parts.store.allows_gaze(run.session.id); }

void record_ipd(const Running& run) {
  if (const auto ipd_mm = run.parts.slots->ipd_mm())
    run.parts.store.add_ipd(run.session.id, run.now_ns(), *ipd_mm);
}

/// Lets the gaze source buffer samples during the lifetime of this object.
class Listening {
 public:
  explicit Listening(GazeSource& gaze) : gaze_(gaze) { gaze_.start(); }
  ~Listening() { gaze_.stop(); }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;

 private:
  GazeSource& gaze_;
};

}  // namespace

Recording::Recording(const Running& run)
    : run_(run),
      gaze_(run.parts.gaze && allowed(run) ? run.parts.gaze : nullptr),
      slots_(run.parts.slots),
      seen_ns_(run.now_ns()),
      heard_ns_(seen_ns_) {
  if (gaze_) gaze_->start();
  if (slots_) slots_->start_slots(allowed(run));
}

Recording::~Recording() {
  if (gaze_) gaze_->stop();
  if (slots_) slots_->stop_slots();
}

Recorded Recording::take() {
  Recorded out;
  if (gaze_) out.gaze = gaze_->take();
  if (slots_) out.slots = slots_->take_slots();
  if (gaze_ && gaze_->origin() == GazeOrigin::Tracker) watch(out.gaze);
  for (const SlotRecord& slot : out.slots) {
    const bool changed = slot.ipd_mm > 0 && !(ipd_mm_ && std::abs(slot.ipd_mm - *ipd_mm_) <= ipd_change_mm);
    if (!changed) continue;
    out.ipds.push_back({slot.predicted_ns, slot.ipd_mm});
    ipd_mm_ = slot.ipd_mm;
  }
  return out;
}

void Recording::watch(const std::vector<GazeSample>& samples) {
  for (const GazeSample& sample : samples) {
    if (sample.valid) seen_ns_ = std::max(seen_ns_, sample.sampled_ns);
    lost_ = lost_ || sample.sampled_ns - seen_ns_ > longest_gaze_gap_ns;
  }
  // A silent tracker sends no invalid samples either. The times of arrival decide, because a sample may be
  // much older than its arrival.
  const std::int64_t now_ns = run_.now_ns();
  if (!samples.empty()) heard_ns_ = now_ns;
  lost_ = lost_ || now_ns - heard_ns_ > longest_gaze_gap_ns;
}

void Recording::require_gaze() const {
  if (lost_) throw TrialAgain{CutCause::Gaze, gaze_->trouble()};
}

bool comes_true(const Running& run, const std::function<bool()>& condition, double within_s,
                const Check& check) {
  const std::int64_t until_ns = run.now_ns() + std::llround(1e9 * within_s);
  while (!condition()) {
    if (run.now_ns() >= until_ns) return false;
    run.parts.participant.pause({PauseKind::Black, look_again_s}, run.parts.clock, check);
  }
  return true;
}

bool sees_eyes(const Running& run, double within_s, const Check& check) {
  GazeSource* const gaze = run.parts.gaze;
  if (!gaze || gaze->origin() != GazeOrigin::Tracker || !allowed(run)) return true;
  const Listening listening(*gaze);
  const auto seen = [gaze] {
    const std::vector<GazeSample> samples = gaze->take();
    return std::any_of(samples.begin(), samples.end(), [](const GazeSample& one) { return one.valid; });
  };
  return comes_true(run, seen, within_s, check);
}

std::string Recording::followed(const Running& run) {
  const std::string& planned = run.session.plan.gaze_source;
  if (planned != "tracked" || !run.parts.gaze || allowed(run)) return planned;
  return run.parts.slots ? "head" : "fixed";
}

void record_headset(const Running& run) {
  if (!run.parts.slots) return;
  run.parts.store.add_headset(run.session.id, run.parts.slots->facts());
  record_ipd(run);
}

void record_tracker(const Running& run) {
  if (!run.parts.gaze) return;
  run.parts.gaze->take_clocks();  // those of an earlier session
  if (const auto clock = run.parts.gaze->clock())
    run.parts.store.add_tracker_clocks(run.session.id, {&*clock, 1});
}

void log_tracker(const Running& run) {
  if (!run.parts.gaze) return;
  run.parts.store.add_tracker_clocks(run.session.id, run.parts.gaze->take_clocks());
  for (const std::string& news : run.parts.gaze->take_gaze_news())
    run.parts.store.log(run.session.id, "gaze", news, run.now_ns());
}

std::string log_news(const Running& run) {
  if (!run.parts.slots) return "";
  std::string all;
  for (const std::string& news : run.parts.slots->take_news()) {
    run.parts.store.log(run.session.id, "headset", news, run.now_ns());
    all += (all.empty() ? "" : ", ") + news;
  }
  const std::vector<HeadsetFacts> changed = run.parts.slots->take_facts();
  for (const HeadsetFacts& facts : changed) run.parts.store.add_headset(run.session.id, facts);
  if (!changed.empty()) record_ipd(run);
  return all;
}

}  // namespace study
