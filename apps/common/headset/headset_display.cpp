#include "apps/common/headset/headset_display.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "stats/base/error.hpp"

namespace apps {

namespace {

constexpr std::chrono::seconds most_idle{30};
/// Slots in which a headset that is worn should have been ready, and a rate settled.
constexpr int most_slots = 3000;

study::EyeView to_study(const EyeView& eye, int x_px) {
  study::EyeView out;
  for (std::size_t k = 0; k < 3; ++k) out.position_m[k] = static_cast<double>(eye.pose.place_m[k]);
  for (std::size_t k = 0; k < 4; ++k) out.orientation[k] = static_cast<double>(eye.pose.turn[k]);
  out.left_rad = static_cast<double>(eye.fov.left);
  out.right_rad = static_cast<double>(eye.fov.right);
  out.up_rad = static_cast<double>(eye.fov.up);
  out.down_rad = static_cast<double>(eye.fov.down);
  out.x_px = x_px;
  out.width_px = eye.width_px;
  out.height_px = eye.height_px;
  return out;
}

}  // namespace

HeadsetDisplay::HeadsetDisplay(SlotDrive drive, const HeadsetChoice& choice)
    : loop_(choice, drive), slots_by_thread_(drive == SlotDrive::Thread) {
  await([this] { return focused(); }, "nobody wears it, or another program has its focus",
        "put it on, and close what lies before this program");
  await([this] { return facts().rate.measured_hz.has_value(); }, "its predicted times show no steady rate",
        "choose a fixed refresh rate in the headset's software");
  const HeadsetRate rate = facts().rate;
  refresh_hz_ = rate.told_hz.value_or(*rate.measured_hz);
}

void HeadsetDisplay::await(const std::function<bool()>& ready, const char* problem, const char* mend) {
  const auto since = std::chrono::steady_clock::now();
  for (int slots = 0; !ready(); ++slots) {
    if (slots > most_slots || std::chrono::steady_clock::now() - since > most_idle)
      throw base::Error("headset", problem, mend);
    turn();
  }
}

std::string HeadsetDisplay::description() const {
  return session().description() + ", " + sim::gl_description();
}

study::TimingGrade HeadsetDisplay::grade() const {
  return facts().trusted ? study::TimingGrade::Compositor : study::TimingGrade::CpuSubmit;
}

double HeadsetDisplay::measured_hz() const { return facts().rate.measured_hz.value_or(refresh_hz_); }

std::int64_t HeadsetDisplay::first_onset(std::int64_t earliest_ns) const {
  const std::int64_t period_ns = loop_.period_ns(), next_ns = loop_.next_ns();
  const std::int64_t ahead_ns = std::max<std::int64_t>(0, earliest_ns - next_ns) + lead_ns();
  return next_ns + (ahead_ns + period_ns - 1) / period_ns * period_ns;
}

/// How long before its slot a picture is drawn.
std::int64_t HeadsetDisplay::lead_ns() const {
  return slots_by_thread_ ? draw_ns_ + draw_ns_ / 2 + loop_.period_ns() : 0;
}

/// What happened to the session.
void HeadsetDisplay::heed() {
  using Kind = HeadsetEvent::Kind;
  for (const HeadsetEvent& event : loop_.take_events()) {
    const bool state = event.kind == Kind::State;
    if (state && event.state == HeadsetState::Exiting)
      throw base::Error("headset", "its software asked the program to leave",
                        "continue with vip-study resume");
    if (event.kind == Kind::RuntimeEnds || (state && event.state == HeadsetState::LossPending))
      throw base::Error("headset", "its software ends", "start it again and continue with vip-study resume");
    if (event.kind == Kind::Refresh) refresh_hz_ = event.to_hz;
    const bool unseen = state && event.state != HeadsetState::Focused;
    if (unseen || event.kind == Kind::Refresh || event.kind == Kind::Recentred) spoilt_ |= playing_;
  }
  spoilt_ |= loop_.take_unseen() && playing_;
}

void HeadsetDisplay::turn() {
  loop_.turn();
  heed();
}

void HeadsetDisplay::turn_until(std::int64_t deadline_ns) {
  while (loop_.next_ns() < deadline_ns - loop_.period_ns() / 2) turn();
}

std::vector<HeadsetRecord> HeadsetDisplay::next_records() {
  turn();
  return take_records();
}

/// Both eyes into the canvas, as they will be at at_ns.
EyeViews HeadsetDisplay::draw(std::int64_t at_ns) {
  const auto begun = std::chrono::steady_clock::now();
  const EyeViews views = loop_.views_at(at_ns);
  const sim::Offscreen& canvas = loop_.canvas();
  const std::array<study::EyeView, 2> eyes{to_study(views[0], 0), to_study(views[1], views[0].width_px)};
  if (can_be_shown(views)) pending_->draw({canvas.framebuffer(), canvas.width(), canvas.height(), eyes});
  if (!slots_by_thread_) return views;
  glFinish();
  const std::chrono::nanoseconds taken = std::chrono::steady_clock::now() - begun;
  draw_ns_ = std::max<std::int64_t>(taken.count(), draw_ns_ - draw_ns_ / 8);
  return views;
}

void HeadsetDisplay::render(study::Stimulus& stimulus) {
  pending_ = &stimulus;
  // The first picture of a presentation takes longest, and tells how early the others must begin.
  if (slots_by_thread_ && !playing_) draw(loop_.next_ns());
}

study::PresentTimes HeadsetDisplay::present(std::int64_t scheduled_ns, study::Clock& clock) {
  playing_ = true;
  clock.wait_until(scheduled_ns - lead_ns());
  const EyeViews views = draw(scheduled_ns);
  study::PresentTimes times;
  times.submitted_ns = slots_by_thread_ ? study::RealClock().now_ns() : scheduled_ns;
  if (can_be_shown(views)) {
    times.predicted_display_ns = loop_.show(views, scheduled_ns).predicted_ns;
  } else {
    spoilt_ = true;
    clock.wait_until(scheduled_ns);
    times.predicted_display_ns = scheduled_ns;
  }
  heed();
  return times;
}

void HeadsetDisplay::clear() {
  loop_.clear();
  playing_ = false;
}

bool HeadsetDisplay::take_spoilt() { return std::exchange(spoilt_, false); }

}  // namespace apps
