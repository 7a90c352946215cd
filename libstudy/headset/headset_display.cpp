#include "libstudy/headset/headset_display.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <thread>
#include <utility>

#include "libstudy/pacing/nominal_refresh.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::chrono::seconds most_idle_waiting{30};
/// Largest number of slots to wait for a worn headset and for a settled rate.
constexpr int most_slots = 3000;

/// Rates with a relative difference up to same_rate count as equal.
constexpr double same_rate = 0.02;
bool near_rate(double a_hz, double b_hz) { return std::abs(a_hz - b_hz) <= same_rate * b_hz; }

std::string rate_problem(const HeadsetRules& rules) {
  return rules.refresh_hz ? "its refresh rate does not change to the protocol's refresh_hz = " +
                                base::shortest(*rules.refresh_hz)
                          : "the times that it predicts for its frames show no steady rate";
}
constexpr const char* rate_mend =
    "set a fixed refresh rate (refresh_hz, if the protocol has it) in its software";

HeadsetChoice with_rate(HeadsetChoice choice, const HeadsetRules& rules) {
  choice.refresh_hz = rules.refresh_hz;
  return choice;
}

/// The cause of a cut if the session's state is not Focused, or if nobody wears the headset.
CutCause cause_of(HeadsetState state) {
  if (state == HeadsetState::LossPending) return CutCause::SessionLost;
  return state == HeadsetState::Visible ? CutCause::Focus : CutCause::TakenOff;
}

void widen(EyeViews& views, double margin_deg) {
  constexpr float most = 1.55f;  // rad; the picture is a plane, so its edges stay below a right angle
  const auto margin = static_cast<float>(margin_deg * std::numbers::pi / 180);
  for (HeadsetEye& eye : views) {
    eye.fov.left = std::max(eye.fov.left - margin, -most);
    eye.fov.right = std::min(eye.fov.right + margin, most);
    eye.fov.up = std::min(eye.fov.up + margin, most);
    eye.fov.down = std::max(eye.fov.down - margin, -most);
  }
}

}  // namespace

HeadsetDisplay::HeadsetDisplay(SlotDrive drive, const HeadsetChoice& choice, const HeadsetRules& rules)
    : rules_(rules), loop_(with_rate(choice, rules), drive), slots_by_thread_(drive == SlotDrive::Thread) {
  await([this] { return focused(); }, "it is not worn, or another program has its focus",
        "put it on, and close menus, overlays and other programs in it");
  await([this] { return (refresh_hz_ = met_hz().value_or(0)) > 0; }, rate_problem(rules), rate_mend);
  if (drive == SlotDrive::Caller) check_time_stands_still();
  // Discards what a change to the requested rate noted.
  spoilt_.reset();
  take_news();
  take_rates();
}

/// The nominal rate, Hz, if the measured rate has settled and meets the rules; none otherwise.
std::optional<double> HeadsetDisplay::met_hz() const {
  const auto [reported_hz, measured_hz] = facts().rate;
  if (!measured_hz || (rules_.refresh_hz && !near_rate(*measured_hz, *rules_.refresh_hz))) return {};
  return nominal_refresh(*measured_hz, reported_hz.value_or(0));
}

/// The rate changed, by an event of the runtime or by measurement. Cuts also while no stimulus is shown: the
/// schedule of the current trial has the old rate's intervals.
void HeadsetDisplay::change_rate(double from_hz, double to_hz) {
  news_.push_back("the refresh rate changed from " + base::shortest(std::round(100 * from_hz) / 100) +
                  " to " + base::shortest(std::round(100 * to_hz) / 100) + " Hz");
  if (unsettled_) rates_.push_back(*unsettled_);
  const bool reported = facts().rate.reported_hz.has_value();
  unsettled_ = reported ? HeadsetRate{to_hz, {}} : HeadsetRate{{}, to_hz};
  refresh_hz_ = nominal_refresh(to_hz);
  note_cut(spoilt_, CutCause::Rate);
}

/// Takes the rate over once it is measured: after a change, and of a new session, which counts as made only
/// then, because the schedules of trials depend on its rate.
void HeadsetDisplay::settle_rate() {
  const HeadsetRate rate = facts().rate;
  if (!rate.measured_hz || !(unsettled_ || new_session_)) return;
  if (new_session_) news_.emplace_back("a session was made anew");
  new_session_ = false;
  unsettled_.reset();
  rates_.push_back(rate);
  const double hz = nominal_refresh(*rate.measured_hz, rate.reported_hz.value_or(0));
  if (near_rate(hz, refresh_hz_)) return;
  refresh_hz_ = hz;
  note_cut(spoilt_, CutCause::Rate);
}

/// base::Error if the runtime's time advances while the program makes no calls: such a runtime would drop
/// slots while the program computes.
void HeadsetDisplay::check_time_stands_still() {
  turn();
  const std::int64_t before_ns = facts().last.predicted_ns;
  std::this_thread::sleep_for(std::chrono::nanoseconds(5 * loop_.period_ns()));
  turn();
  if (facts().last.predicted_ns - before_ns > 3 * loop_.period_ns())
    throw base::Error("--clock virtual", "the headset's time does not wait for the program",
                      "use --clock real");
}

void HeadsetDisplay::await(const std::function<bool()>& ready, const std::string& problem, const char* mend) {
  const auto since = std::chrono::steady_clock::now();
  for (int slots = 0; !ready(); ++slots) {
    if (slots > most_slots || std::chrono::steady_clock::now() - since > most_idle_waiting)
      throw base::Error("headset", problem, mend);
    turn();
  }
}

std::string HeadsetDisplay::description() const {
  return session().description + ", " + sim::gl_description();
}

bool HeadsetDisplay::focused() const {
  const LoopFacts now = facts();
  return now.state == HeadsetState::Focused && now.worn && !new_session_;
}

TimingGrade HeadsetDisplay::grade() const {
  return facts().trusted ? TimingGrade::Compositor : TimingGrade::CpuSubmit;
}

double HeadsetDisplay::measured_hz() const { return facts().rate.measured_hz.value_or(refresh_hz_); }

std::int64_t HeadsetDisplay::first_onset(std::int64_t earliest_ns) const {
  const std::int64_t period_ns = loop_.period_ns(), next_ns = loop_.next_ns();
  const std::int64_t ahead_ns = std::max<std::int64_t>(0, earliest_ns - next_ns) + lead_ns();
  return next_ns + (ahead_ns + period_ns - 1) / period_ns * period_ns;
}

/// Time from the start of drawing a picture to the picture's slot, ns; 0 with SlotDrive::Caller.
std::int64_t HeadsetDisplay::lead_ns() const {
  return slots_by_thread_ ? draw_ns_ + draw_ns_ / 2 + loop_.period_ns() : 0;
}

/// Processes the session's events: notes causes of a cut; throws if the headset's software ends or asks the
/// program to leave.
void HeadsetDisplay::poll_requests() {
  using Kind = HeadsetEvent::Kind;
  for (const HeadsetEvent& event : loop_.take_events()) {
    const bool state = event.kind == Kind::State;
    if (state && event.state == HeadsetState::Exiting)
      throw DisplayGone(CutCause::ServiceGone, "headset", "its software asked the program to leave",
                        "vip-study resume continues a session");
    if (event.kind == Kind::RuntimeEnds)
      throw DisplayGone(CutCause::ServiceGone, "headset", "its software is shutting down",
                        "start it again; vip-study resume continues a session");
    if (event.kind == Kind::Lost) news_.emplace_back("the headset's software lost the session");
    new_session_ |= event.kind == Kind::Lost;
    if (event.kind == Kind::Lost && playing_) note_cut(spoilt_, CutCause::SessionLost);
    if (event.kind == Kind::Refresh && !new_session_) change_rate(event.from_hz, event.to_hz);
    if (state && event.state != HeadsetState::Focused && playing_) note_cut(spoilt_, cause_of(event.state));
    if (event.kind == Kind::Presence && !event.worn && playing_) note_cut(spoilt_, CutCause::TakenOff);
  }
  const auto unseen = loop_.take_unseen();
  if (unseen && playing_) note_cut(spoilt_, *unseen);
  settle_rate();
}

void HeadsetDisplay::turn() {
  loop_.turn();
  poll_requests();
}

void HeadsetDisplay::turn_until(std::int64_t deadline_ns) {
  while (loop_.next_ns() < deadline_ns - loop_.period_ns() / 2) turn();
}

void HeadsetDisplay::share_records() {
  const auto news = loop_.take_records();
  for (auto* all : {&for_pages_, &for_record_}) {
    if (all->size() + news.size() > FrameLoop::most_records)
      all->erase(all->begin(), all->begin() + static_cast<std::ptrdiff_t>(all->size() / 2));
    all->insert(all->end(), news.begin(), news.end());
  }
}

std::vector<HeadsetRecord> HeadsetDisplay::take_records() {
  share_records();
  return std::exchange(for_pages_, {});
}

std::vector<HeadsetRecord> HeadsetDisplay::take_for_record() {
  share_records();
  return std::exchange(for_record_, {});
}

std::vector<HeadsetRecord> HeadsetDisplay::next_records() {
  turn();
  return take_records();
}

/// Draws the pictures of both eyes for their predicted poses at at_ns. Returns the views that were drawn;
/// none if the poses are unknown.
std::optional<HeldViews> HeadsetDisplay::draw(std::int64_t at_ns) {
  const auto begun = std::chrono::steady_clock::now();
  // canvas() comes before views_at(), because a move of the world's origin after canvas() drops the picture.
  const sim::Offscreen& canvas = loop_.canvas();
  EyeViews views = loop_.views_at(at_ns);
  if (!can_be_shown(views)) return {};
  widen(views, rules_.hold_margin_deg);
  const std::array<EyeView, 2> eyes{study_view(views[0], 0, rules_.world_scale),
                                    study_view(views[1], views[0].width_px, rules_.world_scale)};
  pending_->draw({canvas.framebuffer(), canvas.width(), canvas.height(), eyes});
  const bool in_head = rules_.hold == Hold::HeadLocked;
  const HeldViews from{in_head ? loop_.views_in_head(at_ns) : views, in_head};
  if (!slots_by_thread_) return from;
  glFinish();
  const std::chrono::nanoseconds taken = std::chrono::steady_clock::now() - begun;
  draw_ns_ = std::max<std::int64_t>(taken.count(), draw_ns_ - draw_ns_ / 8);
  return from;
}

void HeadsetDisplay::render(Stimulus& stimulus) {
  pending_ = &stimulus;
  if (playing_) return;
  if (!focused()) note_cut(spoilt_, cause_of(new_session_ ? HeadsetState::LossPending : facts().state));
  // Measures the drawing time, on which lead_ns() depends, with the first picture, which takes longest.
  if (slots_by_thread_) draw(loop_.next_ns());
}

PresentTimes HeadsetDisplay::present(std::int64_t scheduled_ns, Clock& clock) {
  playing_ = true;
  clock.wait_until(scheduled_ns - lead_ns());
  const auto from = spoilt_ ? std::nullopt : draw(scheduled_ns);
  PresentTimes times;
  times.submitted_ns = slots_by_thread_ ? RealClock().now_ns() : scheduled_ns;
  if (from) {
    times.predicted_display_ns = loop_.show(*from, scheduled_ns).predicted_ns;
  } else {
    clock.wait_until(scheduled_ns);
    poll_requests();
    if (!spoilt_) spoilt_ = new_session_ ? CutCause::SessionLost : CutCause::Pose;
    times.predicted_display_ns = scheduled_ns;
  }
  poll_requests();
  return times;
}

void HeadsetDisplay::hold(std::int64_t until_ns, Clock&) {
  if (rules_.hold != Hold::State || !playing_) return;
  // Stops before until_ns: a picture that is not drawn in time would delay the next frame.
  while (!spoilt_ && loop_.next_ns() < until_ns - lead_ns() - loop_.period_ns() / 2) {
    const std::int64_t at_ns = loop_.next_ns() + draw_ns_;
    const auto from = draw(at_ns);
    if (!from) return;
    loop_.show(*from, at_ns);
    poll_requests();
  }
}

void HeadsetDisplay::clear() {
  loop_.clear();
  playing_ = false;
}

std::optional<CutCause> HeadsetDisplay::take_spoilt() { return std::exchange(spoilt_, {}); }

std::optional<CutCause> HeadsetDisplay::take_explained() {
  constexpr int most_unexplained = 10;
  std::optional<CutCause> cause = take_spoilt();
  if (cause) clear();
  for (int slots = 0; slots < most_unexplained; ++slots) {
    if (cause != CutCause::NotDrawn && cause != CutCause::Focus) break;
    turn();
    const HeadsetState state = facts().state;
    if (state != HeadsetState::Focused) note_cut(cause, cause_of(state));
  }
  return cause;
}

}  // namespace study
