#include <algorithm>
#include <cmath>
#include <numeric>

#include "libstudy/pacing/pacer.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

// Least time from the end of the first frame's rendering to its deadline, ns, so that present() can meet this
// deadline.
constexpr std::int64_t lead_ns = 2'000'000;

/// Computes which content step a frame shows.
class ContentCourse {
 public:
  ContentCourse(const ContentRules& rules, Stimulus& stimulus) : rules_(rules), stimulus_(stimulus) {
    length_ = stimulus.length();
    if (length_ > 0 && rules.start_frame >= length_) {
      throw base::Error(stimulus.description(),
                        "ends after " + std::to_string(length_) +
                            " content steps, before start_frame = " + std::to_string(rules.start_frame),
                        "lower start_frame in the protocol or bake more frames");
    }
    rewind();
  }

  /// Prepares the content step of frame `index`, which is scheduled onset_ns after the first frame.
  FrameFacts prepare(std::int64_t index, std::int64_t onset_ns) {
    const std::int64_t next = step_at(index, onset_ns);
    if (next < step_) rewind();
    step_ = next;
    return stimulus_.prepare(step_);
  }

  std::int64_t step() const { return step_; }

 private:
  std::int64_t step_at(std::int64_t index, std::int64_t onset_ns) {
    // The animation error moves the content of every second frame, so that the steps of the content between
    // frames are alternately longer and shorter.
    const double moved_s = (index % 2 == 1 ? rules_.animation_error_s : 0) - rules_.latency_s;
    const double elapsed =
        std::max(0.0, 1e-9 * static_cast<double>(onset_ns) + moved_s) / rules_.content_step_s;
    // Adds a millionth of a step, because rounding may put an onset at the start of a step into the step
    // before.
    const std::int64_t gone =
        rules_.real_time ? std::max(gone_, static_cast<std::int64_t>(elapsed + 1e-6)) : index;
    gone_ = gone;
    if (length_ == 0) return rules_.start_frame + gone;
    const std::int64_t span = length_ - rules_.start_frame;
    return rules_.start_frame + (rules_.at_end == AtEnd::Loop ? gone % span : std::min(gone, span - 1));
  }

  void rewind() {
    stimulus_.start(rules_.start_frame);
    step_ = rules_.start_frame;
  }

  const ContentRules& rules_;
  Stimulus& stimulus_;
  std::int64_t length_ = 0;
  std::int64_t step_ = 0;
  std::int64_t gone_ = 0;  ///< content steps since the first frame; a rewind does not reset it
};

FrameRecord make_frame(std::int64_t index, std::int64_t onset_ns, ContentCourse& course, Stimulus& stimulus,
                       Display& display) {
  FrameRecord record;
  record.index = index;
  record.facts = course.prepare(index, onset_ns);
  record.content_step = course.step();
  display.render(stimulus);
  return record;
}

void check_intervals(const std::vector<std::int64_t>& intervals_ns) {
  const bool good = !intervals_ns.empty() && std::all_of(intervals_ns.begin(), intervals_ns.end(),
                                                         [](std::int64_t ns) { return ns > 0; });
  if (!good) {
    throw base::Error("schedule", "is empty or has an interval of 0 ns or less",
                      "correct the code that made the intervals; compile_schedule() makes valid ones");
  }
}

}  // namespace

ContentRules content_of(ContentRules rules, const FpsSetting& setting) {
  if (!setting.profile) return rules;
  rules.latency_s = 1e-3 * setting.profile->latency_ms;
  rules.animation_error_s = 1e-3 * setting.profile->animation_error_ms;
  return rules;
}

PlayedTrial play_trial(const std::vector<std::int64_t>& intervals_ns, const ContentRules& content,
                       Stimulus& stimulus, Display& display, Clock& clock, const ShowingBounds& bounds,
                       const std::function<void(const FrameRecord&)>& each) {
  check_intervals(intervals_ns);
  ContentCourse course(content, stimulus);
  PlayedTrial played;
  played.frames.reserve(intervals_ns.size());
  const std::int64_t length_ns = std::accumulate(intervals_ns.begin(), intervals_ns.end(), std::int64_t{0});
  std::int64_t first_ns = 0;
  std::int64_t onset_ns = 0;
  std::int64_t making_ns = 0;  // largest recent time to make a frame; decays by an eighth with each frame
  for (std::size_t i = 0; i < intervals_ns.size(); ++i) {
    if (i > 0) display.hold(first_ns + onset_ns - 2 * making_ns, clock);
    const std::int64_t begun_ns = clock.now_ns();
    FrameRecord record = make_frame(static_cast<std::int64_t>(i), onset_ns, course, stimulus, display);
    making_ns = std::max(clock.now_ns() - begun_ns, making_ns - making_ns / 8);
    if (i == 0) first_ns = display.first_onset(clock.now_ns() + lead_ns);
    if (i > 0 && clock.now_ns() - first_ns > length_ns + bounds.overrun_ns) {
      played.cut = static_cast<std::int64_t>(intervals_ns.size() - i);
      clock.wait_until(placed_ns(played.frames.back().times, display.grade()) + intervals_ns[i - 1]);
      played.end_ns = clock.now_ns();
      return played;
    }
    record.scheduled_ns = first_ns + onset_ns;
    record.times = display.present(record.scheduled_ns, clock);
    record.late = placed_ns(record.times, display.grade()) - record.scheduled_ns > bounds.late_after_ns;
    played.frames.push_back(record);
    if (each) each(record);
    onset_ns += intervals_ns[i];
  }
  const std::int64_t last_ns = placed_ns(played.frames.back().times, display.grade());
  const std::int64_t planned_end_ns = first_ns + length_ns;
  display.hold(planned_end_ns, clock);
  clock.wait_until(last_ns < planned_end_ns ? planned_end_ns : last_ns + intervals_ns.back());
  played.end_ns = clock.now_ns();
  return played;
}

PlayedTrial play_native(double duration_s, const ContentRules& content, Stimulus& stimulus, Display& display,
                        Clock& clock, std::int64_t overrun_ns,
                        const std::function<void(const FrameRecord&)>& each) {
  ContentCourse course(content, stimulus);
  PlayedTrial played;
  const auto duration_ns = static_cast<std::int64_t>(1e9 * duration_s);
  for (std::int64_t index = 0;; ++index) {
    const std::int64_t begun_ns = played.frames.empty() ? 0 : clock.now_ns() - played.frames[0].scheduled_ns;
    FrameRecord record = make_frame(index, begun_ns, course, stimulus, display);
    record.scheduled_ns = clock.now_ns();
    if (index > 0 && record.scheduled_ns <= played.frames.back().scheduled_ns) {
      throw base::Error("timing = \"native\"",
                        "needs a clock that runs while frames are made; the virtual clock stands still",
                        "use --clock real");
    }
    const std::int64_t gone_ns =
        played.frames.empty() ? 0 : record.scheduled_ns - played.frames[0].scheduled_ns;
    if (index > 0 && gone_ns >= duration_ns) {
      played.end_ns = record.scheduled_ns;
      if (gone_ns - duration_ns > overrun_ns) played.cut = 0;
      return played;
    }
    record.times = display.present(record.scheduled_ns, clock);
    played.frames.push_back(record);
    if (each) each(record);
  }
}

}  // namespace study
