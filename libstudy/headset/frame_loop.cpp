#include "libstudy/headset/frame_loop.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/headset/system.hpp"
#include "libstudy/pacing/real_time.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::chrono::seconds most_idle{30};
constexpr std::chrono::milliseconds slot_wait{100};

std::int64_t system_ns() { return RealClock().now_ns(); }

/// Refresh period of the display, ns; 0 before any slot.
std::int64_t period_of(const LoopFacts& facts) {
  const auto hz = facts.rate.measured_hz;
  return hz ? std::llround(1e9 / *hz) : facts.last.period_ns;
}

}  // namespace

FrameLoop::FrameLoop(const HeadsetChoice& choice, SlotDrive drive)
    : gl_(make_headset_context()), drive_(drive), page_size_{choice.page_width_px, choice.page_height_px} {
  if (drive == SlotDrive::Caller) {
    maker_.emplace(gl_, choice);
    make_session();
  } else {
    slots_gl_.emplace(gl_.make_shared());
    maker_.emplace(*slots_gl_, choice);
    thread_ = std::thread([this] { run(); });
    std::unique_lock held(mutex_);
    changed_.wait(held, [this] { return session_ || error_; });
    if (error_) {
      held.unlock();
      stop();
      std::rethrow_exception(error_);
    }
  }
  try {
    make_pictures(PictureTurns::count);
  } catch (...) {
    stop();
    throw;
  }
}

void FrameLoop::make_pictures(std::size_t count) {
  const base::PictureSize size = session().picture;
  while (canvases_.size() < count) {
    auto canvas = std::make_unique<sim::Offscreen>(size.width, size.height);
    std::unique_ptr<sim::Offscreen> page;
    if (page_size_.width > 0) page = std::make_unique<sim::Offscreen>(page_size_.width, page_size_.height);
    const std::lock_guard held(mutex_);
    canvases_.push_back(std::move(canvas));
    if (page) pages_.push_back(std::move(page));
  }
}

FrameLoop::~FrameLoop() { stop(); }

void FrameLoop::stop() {
  {
    const std::lock_guard held(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void FrameLoop::make_session() {
  auto made = maker_->make(facts_.last.predicted_ns);
  SessionFacts reported = facts_of(*made);
  {
    const std::scoped_lock held(asking_, mutex_);
    session_ = std::move(made);
    reported_ = std::move(reported);
  }
  changed_.notify_all();
}

/// Replaces the session that the runtime lost by a new session.
void FrameLoop::make_anew() {
  std::unique_ptr<HeadsetSession> lost;
  const SessionFacts before = session();
  {
    const std::scoped_lock held(asking_, mutex_);
    lost = std::move(session_);
    running_ = false;
    facts_.state = HeadsetState::LossPending;
    facts_.rate = {};
    facts_.worn = true;
    facts_.last.runtime_time = facts_.last.index = 0;  // the next session counts from 0
    ++facts_.world;
    moves_ns_.clear();
    black_out(CutCause::SessionLost);
    events_.push_back({.kind = HeadsetEvent::Kind::Lost});
  }
  changed_.notify_all();
  lost.reset();
  make_session();
  require_alike(before, session());
  const std::lock_guard held(mutex_);
  events_.push_back({.kind = HeadsetEvent::Kind::MadeAnew});
}

/// Body of the slot thread: makes the session, runs its slots and destroys it, all in the context slots_gl_.
void FrameLoop::run() {
  try {
    const RealTimeScheduling real_time;
    slots_gl_->make_current();
    make_session();
    draw_slots();
  } catch (...) {
    const std::lock_guard held(mutex_);
    error_ = std::current_exception();
    running_ = false;
  }
  changed_.notify_all();
  std::unique_lock held(mutex_);
  if (session_) changed_.wait(held, [this] { return stopping_; });
  held.unlock();
  session_.reset();
  slots_gl_->release();
}

void FrameLoop::draw_slots() {
  for (;;) {
    const bool turned = turn_slot();
    std::unique_lock held(mutex_);
    if (!turned) changed_.wait_for(held, std::chrono::milliseconds(1), [this] { return stopping_; });
    if (stopping_) return;
  }
}

/// Runs one slot, or replaces a lost session. Returns false if no slot was run.
bool FrameLoop::turn_slot() {
  try {
    if (poll()) {
      const HeadsetSlot slot = session_->wait();
      session_->begin(slot);
      session_->end(slot, take_in({slot, session_->views(slot), session_->input(slot)}));
      return true;
    }
    if (session_->state() != HeadsetState::LossPending || runtime_ends_) return false;
  } catch (const HeadsetLost& lost) {
    if (lost.with_runtime() || runtime_ends_) throw;
  }
  make_anew();
  return false;
}

/// Processes the session's events. Returns true if the session runs frames.
bool FrameLoop::poll() {
  const std::vector<HeadsetEvent> events = session_->poll();
  const std::lock_guard held(mutex_);
  events_.insert(events_.end(), events.begin(), events.end());
  for (const HeadsetEvent& event : events) {
    using Kind = HeadsetEvent::Kind;
    // The lost events may include a move of the world's origin, so EventsLost counts as a move. Its at_ns is
    // -1, so this move takes effect at the next slot.
    if (event.kind == Kind::Recentred || event.kind == Kind::EventsLost) moves_ns_.push_back(event.at_ns);
    if (event.kind == Kind::Presence) facts_.worn = event.worn;
    if (event.kind == Kind::Refresh) facts_.rate.measured_hz.reset();
    runtime_ends_ |= event.kind == Kind::RuntimeEnds;
  }
  facts_.state = session_->state();
  return running_ = session_->running();
}

/// Applies moves of the world's origin: a move takes effect at the first slot whose predicted time is not
/// before the move's time.
void FrameLoop::follow_world(std::int64_t predicted_ns) {
  if (std::erase_if(moves_ns_, [&](std::int64_t at_ns) { return at_ns <= predicted_ns; }) == 0) return;
  ++facts_.world;
  black_out(CutCause::Recentred);
}

/// Removes picture and page, because their positions refer to the world's old origin or to a lost session.
/// Notes the cause if a picture was shown or waiting.
void FrameLoop::black_out(CutCause cause) {
  if (picture_turns_.shows() || picture_turns_.waits()) note_cut(unseen_, cause);
  picture_turns_.drop();
  page_turns_.drop();
}

/// Stores the record of a slot and returns the layers that the slot shows.
HeadsetLayers FrameLoop::take_in(HeadsetRecord record) {
  const HeadsetSlot& slot = record.slot;
  const RateMeter& meter = session_->meter();
  HeadsetRate rate{facts_.rate.reported_hz, meter.hz()};
  // The reported rate is read when the measured rate settles, because it may be wrong before.
  if (rate.measured_hz && !facts_.rate.measured_hz) rate = session_->rate();
  HeadsetLayers out;
  {
    const std::lock_guard held(mutex_);
    facts_.rate = rate;
    // Computed anew in each slot: off_grid() also counts steps during a change of the rate and subtracts them
    // when it detects the change, and a new session has a new meter.
    facts_.trusted = session_->times_convert() && meter.repeated() == 0 && meter.off_grid() == 0;
    facts_.last = slot;
    facts_.views = record.views;
    last_system_ns_ = system_ns();
    ++slots_;
    follow_world(slot.predicted_ns);
    if (picture_turns_.waits() && slot.predicted_ns >= due_ns_ - period_of(facts_) / 2) {
      picture_turns_.take();
      shown_from_ = waiting_from_;
      came_on_ = slot;
    }
    if (page_turns_.waits()) {
      page_turns_.take();
      shown_place_ = waiting_place_;
    }
    out = layers_at(slot.predicted_ns, picture_turns_.read(), page_turns_.read());
    if (!flashes_.admit(slot.predicted_ns, slot.should_render && (out.picture || out.page))) out = {};
    if (picture_turns_.shows() && !(slot.should_render && out.picture)) note_cut(unseen_, CutCause::NotDrawn);
    if (out.picture) record.shown = shown_from_;
    record.world = facts_.world;
    record.input.focused &= facts_.worn;  // input while the headset is off is accidental
    if (records_.size() >= most_records)
      records_.erase(records_.begin(), records_.begin() + most_records / 2);
    records_.push_back(record);
  }
  changed_.notify_all();
  return out;
}

HeadsetLayers FrameLoop::layers_at(std::int64_t at_ns, std::size_t picture, std::size_t page) const {
  HeadsetLayers out;
  if (picture_turns_.shows()) out.picture = canvases_[picture].get();
  if (page_turns_.shows()) out.page = pages_[page].get();
  out.views = shown_from_.views;
  out.in_head = shown_from_.in_head;
  out.light = light_of_held(1e-9 * static_cast<double>(at_ns - came_on_.predicted_ns));
  out.place = shown_place_;
  out.picture_number = picture_turns_.number();
  out.page_number = page_turns_.number();
  return out;
}

sim::GlContext FrameLoop::admit_onlooker() {
  make_pictures(PictureTurns::count_with_onlooker);
  onlooker_ = true;
  return gl_.make_shared();
}

SeenNow FrameLoop::look() {
  const std::lock_guard held(mutex_);
  return {layers_at(facts_.last.predicted_ns, picture_turns_.look(), page_turns_.look()), facts_.views};
}

void FrameLoop::look_away() {
  const std::lock_guard held(mutex_);
  picture_turns_.look_away();
  page_turns_.look_away();
}

void FrameLoop::turn() {
  if (drive_ == SlotDrive::Caller) {
    const auto since = std::chrono::steady_clock::now();
    while (!turn_slot()) {
      if (!events_.empty()) return;  // an event may tell the caller why no slots come
      if (std::chrono::steady_clock::now() - since > most_idle)
        throw DisplayGone(CutCause::TakenOff, "headset",
                          "it has run no frame for 30 s: it is not worn, or its software hangs",
                          "put it on, or restart its software; vip-study resume continues a session");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return;
  }
  std::unique_lock held(mutex_);
  changed_.wait_for(held, slot_wait, [this, before = slots_] { return slots_ > before || error_; });
  // Throws after the caller took the events, because an event may explain why the slot thread failed.
  if (error_ && events_.empty()) std::rethrow_exception(error_);
}

SessionFacts FrameLoop::session() const {
  const std::lock_guard held(mutex_);
  return reported_;
}

LoopFacts FrameLoop::facts() const {
  const std::lock_guard held(mutex_);
  return facts_;
}

std::int64_t FrameLoop::period_ns() const { return period_of(facts()); }

std::int64_t FrameLoop::next_ns() const {
  const std::lock_guard held(mutex_);
  const std::int64_t next_ns = facts_.last.predicted_ns + period_of(facts_);
  return drive_ == SlotDrive::Caller || running_ ? next_ns : next_ns + system_ns() - last_system_ns_;
}

std::int64_t FrameLoop::now_ns() const {
  if (drive_ == SlotDrive::Caller) return next_ns();
  const std::lock_guard held(mutex_);
  const std::int64_t period_ns = period_of(facts_), gone_ns = system_ns() - last_system_ns_;
  const std::int64_t counted_ns = running_ ? std::clamp<std::int64_t>(gone_ns, 0, period_ns) : gone_ns;
  return facts_.last.predicted_ns + period_ns + counted_ns;
}

EyeViews FrameLoop::views_at(std::int64_t at_ns) { return ask_views(&HeadsetSession::views_at, at_ns); }

EyeViews FrameLoop::views_in_head(std::int64_t at_ns) {
  return ask_views(&HeadsetSession::views_in_head, at_ns);
}

EyeViews FrameLoop::ask_views(AskViews ask, std::int64_t at_ns) {
  const std::lock_guard asking(asking_);
  const HeadsetSlot last = facts().last;
  if (!session_ || last.runtime_time == 0) return {};
  try {
    return (session_.get()->*ask)(last.runtime_time + at_ns - last.predicted_ns);
  } catch (const HeadsetLost&) {
    return {};  // the next slot reports the loss
  }
}

const sim::Offscreen& FrameLoop::canvas() {
  const std::lock_guard held(mutex_);
  return *canvases_[picture_turns_.begin()];
}

const sim::Offscreen& FrameLoop::page() {
  const std::lock_guard held(mutex_);
  return *pages_.at(page_turns_.begin());
}

HeadsetSlot FrameLoop::show(const HeldViews& from, std::int64_t due_ns) {
  if (others_read()) glFinish();
  {
    const std::lock_guard held(mutex_);
    picture_turns_.post();
    waiting_from_ = from;
    due_ns_ = due_ns;
  }
  for (;;) {
    turn();
    const std::lock_guard held(mutex_);
    if (picture_turns_.shows() && !picture_turns_.waits()) return came_on_;
    if (picture_turns_.waits() && running_ && !error_) continue;
    // The picture will not be shown: the session does not run, or black_out() dropped the picture.
    picture_turns_.clear();
    if (!running_) note_cut(unseen_, CutCause::TakenOff);
    if (running_ && !unseen_) unseen_ = CutCause::NotDrawn;
    return {.predicted_ns = due_ns};
  }
}

void FrameLoop::clear() {
  const std::lock_guard held(mutex_);
  picture_turns_.clear();
}

void FrameLoop::show_page(const HeadsetPage& place) {
  if (others_read()) glFinish();
  const std::lock_guard held(mutex_);
  page_turns_.post();
  waiting_place_ = place;
}

void FrameLoop::hide_page() {
  const std::lock_guard held(mutex_);
  page_turns_.clear();
}

std::vector<HeadsetEvent> FrameLoop::take_events() {
  const std::lock_guard held(mutex_);
  return std::exchange(events_, {});
}

std::vector<HeadsetRecord> FrameLoop::take_records() {
  const std::lock_guard held(mutex_);
  return std::exchange(records_, {});
}

std::optional<CutCause> FrameLoop::take_unseen() {
  const std::lock_guard held(mutex_);
  return std::exchange(unseen_, {});
}

}  // namespace study
