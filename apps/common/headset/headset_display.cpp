#include "apps/common/headset/headset_display.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "stats/base/error.hpp"

namespace apps {

namespace {

constexpr std::chrono::seconds most_idle{30};
/// Slots in which a headset that is worn should have been ready, and a rate settled.
constexpr int most_slots = 3000;
/// Of those that nobody takes; a minute's and more.
constexpr std::size_t most_records = 20000;

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

HeadsetDisplay::HeadsetDisplay(const HeadsetChoice& choice)
    : gl_(sim::GlContext::make_headless()), session_(std::make_unique<HeadsetSession>(gl_, choice)) {
  const sim::Offscreen &left = session_->picture(0), &right = session_->picture(1);
  canvas_ =
      std::make_unique<sim::Offscreen>(left.width() + right.width(), std::max(left.height(), right.height()));
  become_focused();
  for (int slots = 0; !session_->meter().hz(); ++slots) {
    if (slots > most_slots) {
      throw base::Error("headset", "its predicted times show no steady rate",
                        "choose a fixed refresh rate in the headset's software");
    }
    turn();
  }
  const HeadsetRate rate = session_->rate();
  refresh_hz_ = rate.told_hz.value_or(*rate.measured_hz);
}

std::string HeadsetDisplay::description() const {
  return session_->description() + ", " + sim::gl_description();
}

study::TimingGrade HeadsetDisplay::grade() const {
  const RateMeter& meter = session_->meter();
  const bool trusted = session_->times_convert() && meter.repeated() == 0 && meter.off_grid() == 0;
  return trusted ? study::TimingGrade::Compositor : study::TimingGrade::CpuSubmit;
}

double HeadsetDisplay::measured_hz() const { return session_->meter().hz().value_or(refresh_hz_); }

/// Before the rate has settled no schedule runs.
std::int64_t HeadsetDisplay::period_ns() const {
  const double hz = measured_hz();
  return hz > 0 ? std::llround(1e9 / hz) : 0;
}

std::int64_t HeadsetDisplay::first_onset(std::int64_t earliest_ns) const {
  const std::int64_t ahead_ns = std::max<std::int64_t>(0, earliest_ns - next_ns());
  return next_ns() + (ahead_ns + period_ns() - 1) / period_ns() * period_ns();
}

void HeadsetDisplay::heed(const HeadsetEvent& event) {
  using Kind = HeadsetEvent::Kind;
  if (event.kind == Kind::State && event.state == HeadsetState::Exiting) {
    throw base::Error("headset", "its software asked the program to leave", "continue with vip-study resume");
  }
  const bool goes = event.kind == Kind::State && event.state == HeadsetState::LossPending;
  if (goes || event.kind == Kind::RuntimeEnds) {
    throw base::Error("headset", "its software ends", "start it again and continue with vip-study resume");
  }
  if (event.kind == Kind::Refresh) refresh_hz_ = event.to_hz;
  const bool unseen = event.kind == Kind::State && event.state != HeadsetState::Focused;
  if (unseen || event.kind == Kind::Refresh || event.kind == Kind::Recentred) spoilt_ |= playing_;
}

HeadsetSlot HeadsetDisplay::begin_slot() {
  const auto since = std::chrono::steady_clock::now();
  for (;;) {
    for (const HeadsetEvent& event : session_->poll()) heed(event);
    if (session_->running()) break;
    if (std::chrono::steady_clock::now() - since > most_idle)
      throw base::Error("headset", "nobody wears it", "put it on and continue with vip-study resume");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const HeadsetSlot slot = session_->wait();
  session_->begin(slot);
  last_ns_ = slot.predicted_ns;
  if (records_.size() >= most_records) records_.erase(records_.begin(), records_.begin() + most_records / 2);
  records_.push_back({slot, session_->views(slot), session_->input(slot)});
  spoilt_ |= playing_ && !slot.should_render;
  return slot;
}

void HeadsetDisplay::end_slot(const HeadsetSlot& slot) { session_->end(slot, shown_, page_); }

std::vector<HeadsetRecord> HeadsetDisplay::take_records() { return std::exchange(records_, {}); }

std::vector<HeadsetRecord> HeadsetDisplay::next_records() {
  turn();
  return take_records();
}

void HeadsetDisplay::become_focused() {
  for (int slots = 0; session_->state() != HeadsetState::Focused; ++slots) {
    if (slots > most_slots)
      throw base::Error("headset", "another program has its focus", "close what lies before this program");
    turn();
  }
}

void HeadsetDisplay::draw() {
  const EyeViews views = records_.back().views;
  if (!can_be_shown(views)) {
    spoilt_ = true;
    return;
  }
  const int widths[] = {session_->picture(0).width(), session_->picture(1).width()};
  const std::array<study::EyeView, 2> eyes{to_study(views[0], 0), to_study(views[1], widths[0])};
  pending_->draw({canvas_->framebuffer(), canvas_->width(), canvas_->height(), eyes});
  for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
    const sim::Offscreen& to = session_->picture(eye);
    const int x = eyes[eye].x_px;
    glBlitNamedFramebuffer(canvas_->framebuffer(), to.framebuffer(), x, 0, x + to.width(), to.height(), 0, 0,
                           to.width(), to.height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  shown_ = views;
}

study::PresentTimes HeadsetDisplay::present(std::int64_t scheduled_ns, study::Clock& clock) {
  playing_ = true;
  clock.wait_until(scheduled_ns);
  study::PresentTimes times;
  times.submitted_ns = clock.now_ns();
  const HeadsetSlot slot = begin_slot();
  draw();
  end_slot(slot);
  times.predicted_display_ns = slot.predicted_ns;
  return times;
}

void HeadsetDisplay::clear() {
  shown_.reset();
  playing_ = false;
}

void HeadsetDisplay::turn_until(std::int64_t deadline_ns) {
  while (next_ns() < deadline_ns - period_ns() / 2) turn();
}

bool HeadsetDisplay::take_spoilt() {
  if (!spoilt_) return false;
  clear();
  become_focused();
  spoilt_ = false;
  return true;
}

}  // namespace apps
