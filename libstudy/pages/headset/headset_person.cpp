#include "libstudy/pages/headset/headset_person.hpp"

#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/console/console_text.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/pages/gui/page_surface.hpp"
#include "libstudy/pages/gui/pages.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/pages/headset/dwell.hpp"
#include "libstudy/pages/headset/hand_keys.hpp"
#include "libstudy/pages/headset/page_place.hpp"
#include "libstudy/pages/headset/terminal_keys.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// A surface for pages in a headset: a rectangle in the world, answered by hand, eyes or keyboard.
///
/// A page appears upright in front of the head and stays there until the head turns or moves far away. It
/// fades to black when it ends. Input is ignored while the headset is not focused. A long press of the menu
/// button, or Stop on the page, opens the stop dialog. poll() and show_black() wait for slots (frames) of the
/// headset.
class HeadsetSurface final : public PageSurface {
 public:
  /// display: made with choice_for_person(); it must outlive the surface.
  HeadsetSurface(HeadsetDisplay& display, const AnswerWays& ways, const PageCharacters& characters = {});

  /// From now on, takes keys of the terminal as input, if the ways to answer include the keyboard.
  void listen();
  /// Seconds since the last input by hand or key.
  double idle_s() const;

  Gui& gui() override { return gui_; }
  std::string beginning(const DeskWords& words) const override;
  AnswerInput pointer() const override;
  void poll(double wait_s) override;
  std::vector<PageEvent> take_events() override;
  void forget_input() override;
  std::optional<std::pair<std::int64_t, std::int64_t>> take_away() override {
    return std::exchange(away_, std::nullopt);
  }
  void end() override;
  void show() override;
  void show_black() override;
  std::optional<CutCause> take_unseen() override { return display_.take_explained(); }
  bool unseen() const override { return !display_.focused(); }

 private:
  using Place = std::optional<std::pair<float, float>>;

  void take_in(const std::vector<HeadsetRecord>& records);
  void take_in(const HeadsetRecord& record);
  bool be_away(bool focused, std::int64_t now_ns);
  void take_hands(const HeadsetHands& hands, std::int64_t now_ns);
  void take_look(const HeadsetInput& input, std::int64_t now_ns);
  Place hand_place(const HeadsetHands& hands);
  void tell_gui() const;
  void draw_pointer() const;
  void note_use();

  HeadsetDisplay& display_;
  AnswerWays ways_;
  Gui gui_;
  HandKeys hand_keys_;
  std::unique_ptr<TerminalKeys> terminal_;
  Dwell dwell_;
  std::vector<PageEvent> events_;
  std::optional<std::pair<std::int64_t, std::int64_t>> away_;
  std::optional<std::int64_t> away_since_ns_;
  std::optional<std::int64_t> last_ns_;  ///< predicted time of the previous slot
  HeadsetPose head_;                     ///< last known pose of the head
  /// HeadsetRecord::world of head_ and of page_; it changes when the origin of poses may have moved.
  int head_world_ = 0, page_world_ = 0;
  std::optional<HeadsetPage> page_;  ///< position of the shown page; none: no page
  Place pointer_;                    ///< pointer position, px of the page
  Place stick_from_;      ///< hand pointer's position when the stick was pushed; hides it while set
  bool pressed_ = false;  ///< true: the pointer's button is down
  int clicks_ = 0;        ///< calls of take_look() until a click by dwell is over
  std::size_t hand_ = 1;  ///< the hand that pointed last
  std::int64_t used_ns_;  ///< time of the last input, on the steady clock
};

constexpr double fade_s = 0.2;
constexpr double most_hand_waiting_s = 5;
constexpr float picture_s = 1.0F / 60;  // s; Dear ImGui needs a frame time, which does not affect the pages
// The stick hides the pointer until the hand moves the pointer this far, px: about 2 degrees.
constexpr float moved_px = 60;

float distance(const std::pair<float, float>& a, const std::pair<float, float>& b) {
  return std::hypot(a.first - b.first, a.second - b.second);
}

HeadsetSurface::HeadsetSurface(HeadsetDisplay& display, const AnswerWays& ways,
                               const PageCharacters& characters)
    : display_(display),
      ways_(ways),
      gui_(type_for_x_height(px_of_height(least_x_height_deg)),
           {[this] { tell_gui(); }, [this] { return display_.page().framebuffer(); }, true}, characters),
      used_ns_(steady_ns()) {}

void HeadsetSurface::listen() {
  if (ways_.keyboard) terminal_ = std::make_unique<TerminalKeys>();
}

double HeadsetSurface::idle_s() const { return 1e-9 * static_cast<double>(steady_ns() - used_ns_); }
void HeadsetSurface::note_use() { used_ns_ = steady_ns(); }

AnswerInput HeadsetSurface::pointer() const { return ways_.dwell ? AnswerInput::Dwell : AnswerInput::Ray; }

std::string HeadsetSurface::beginning(const DeskWords& words) const {
  std::string all;
  if (ways_.ray) all += words.by_ray + " ";
  if (ways_.dwell) all += words.by_dwell + " ";
  if (ways_.stick && !ways_.ray) all += words.by_stick + " ";
  return all + words.begin_by_hand;
}

/// Waits for input up to wait_s; returns earlier if the pointer changed, an event came or no slot came.
void HeadsetSurface::poll(double wait_s) {
  std::int64_t until_ns = -1;
  for (;;) {
    const Place place = pointer_;
    const bool pressed = pressed_;
    const auto records = display_.next_records();
    take_in(records);
    if (records.empty() || !events_.empty() || pressed != pressed_ || place != pointer_) return;
    if (until_ns < 0) until_ns = records[0].slot.predicted_ns + std::llround(1e9 * wait_s);
    if (records.back().slot.predicted_ns + records.back().slot.period_ns >= until_ns) return;
  }
}

void HeadsetSurface::take_in(const std::vector<HeadsetRecord>& records) {
  for (const HeadsetRecord& record : records) take_in(record);
}

void HeadsetSurface::take_in(const HeadsetRecord& record) {
  const std::int64_t now_ns = record.slot.predicted_ns;
  if (record.input.head.valid()) {
    head_ = record.input.head;
    head_world_ = record.world;
  }
  if (be_away(record.input.focused, now_ns)) return;
  take_hands(record.input.hands, now_ns);
  if (ways_.dwell) take_look(record.input, now_ns);
}

/// Returns true while the headset is not focused, when input must be ignored. Buttons that are still held
/// down when the focus returns are ignored until released.
bool HeadsetSurface::be_away(bool focused, std::int64_t now_ns) {
  if (!focused && !away_since_ns_) {
    // Counts from the last slot before now_ns, because no slots come while the headset is not worn or the
    // session is lost.
    away_since_ns_ = last_ns_.value_or(now_ns);
    pointer_.reset();
    pressed_ = false;
    dwell_.reset();
  }
  if (focused && away_since_ns_) {
    away_ = {away_ ? away_->first : *away_since_ns_, now_ns};
    away_since_ns_.reset();
    hand_keys_.forget();
  }
  last_ns_ = now_ns;
  return !focused;
}

/// The point of the page at which a hand points, preferably the hand that pointed last; none if no hand
/// points at the page.
HeadsetSurface::Place HeadsetSurface::hand_place(const HeadsetHands& hands) {
  for (const std::size_t hand : {hand_, 1 - hand_}) {
    const auto& aim = hands.aim[hand];
    const Place place = page_ && aim && aim->valid() ? meet_page(*page_, *aim) : Place();
    if (!place) continue;
    hand_ = hand;
    return place;
  }
  return {};
}

void HeadsetSurface::take_hands(const HeadsetHands& hands, std::int64_t now_ns) {
  const auto keys = hand_keys_.take(hands, ways_.stick, now_ns);
  events_.insert(events_.end(), keys.begin(), keys.end());
  const bool stick = std::any_of(keys.begin(), keys.end(), [](const auto& one) { return one.key; });
  if (hands.select || hands.menu || stick) note_use();
  if (hands.select_began)
    events_.push_back({.pressed = true, .input = ways_.ray ? AnswerInput::Ray : AnswerInput::Stick});
  const Place place = ways_.ray ? hand_place(hands) : Place();
  if (stick) stick_from_ = place.value_or(std::pair{-FLT_MAX, -FLT_MAX});
  const bool put_away = stick_from_ && (!place || distance(*place, *stick_from_) < moved_px);
  if (place && !put_away) stick_from_.reset();
  if (ways_.stick && hands.select_began && (put_away || !ways_.ray))
    events_.push_back({.key = PageKey::Enter, .input = AnswerInput::Stick});
  if (ways_.dwell) return;
  pointer_ = put_away ? Place() : place;
  pressed_ = pointer_ && hands.select;
}

/// Moves the pointer to the point looked at: along the eyes' ray or, without a tracker, the head's ray.
void HeadsetSurface::take_look(const HeadsetInput& input, std::int64_t now_ns) {
  const bool eyes = display_.session().eye_gaze;
  const HeadsetPose ray = !eyes ? input.head : input.gaze ? input.gaze->ray : HeadsetPose();
  const bool seen = ray.valid();
  if (clicks_ > 0) --clicks_;  // the pointer is fixed during the click, though the eyes move
  const bool clicking = clicks_ > 0;
  if (!clicking && seen) pointer_ = page_ ? meet_page(*page_, ray) : Place();
  if (dwell_.look(pointer_ ? gui_.pointed_at() : 0, seen, now_ns)) clicks_ = 3;
  pressed_ = clicks_ == 3;
}

std::vector<PageEvent> HeadsetSurface::take_events() {
  take_in(display_.take_records());
  if (terminal_) {
    const auto typed = terminal_->take();
    if (!typed.empty()) note_use();
    if (!away_since_ns_) events_.insert(events_.end(), typed.begin(), typed.end());
  }
  if (gui_.take_stop()) events_.push_back({.stop = true});
  return std::exchange(events_, {});
}

void HeadsetSurface::forget_input() {
  display_.take_records();
  if (terminal_) terminal_->take();
  events_.clear();
  away_.reset();
  hand_keys_.forget();
  dwell_.reset();
  clicks_ = 0;
  gui_.take_stop();
  take_unseen();
}

void HeadsetSurface::tell_gui() const {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {page_width_px, page_height_px};
  io.DeltaTime = picture_s;
  io.MousePos = pointer_ ? ImVec2{pointer_->first, pointer_->second} : ImVec2{-FLT_MAX, -FLT_MAX};
  io.MouseDown[0] = pressed_;
}

void HeadsetSurface::draw_pointer() const {
  if (!pointer_) return;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const ImVec2 at{pointer_->first, pointer_->second};
  const float size = gui_.size_px();
  if (!ways_.dwell) {
    list.AddCircleFilled(at, 0.24F * size, colour::black);
    list.AddCircleFilled(at, 0.17F * size, colour::text);
    return;
  }
  list.AddCircleFilled(at, 0.1F * size, colour::dim);
  const float turn = dwell_.progress() * 2 * std::numbers::pi_v<float>, top = -std::numbers::pi_v<float> / 2;
  if (turn <= 0) return;
  list.PathArcTo(at, 0.7F * size, top, top + turn, 40);
  list.PathStroke(colour::text, 0, 0.14F * size);
}

void HeadsetSurface::end() {
  draw_pointer();
  gui_.end();
}

void HeadsetSurface::show() {
  if (!page_) display_.clear();  // otherwise the last picture would stay frozen behind the page
  if (!page_ || page_world_ != head_world_ || is_left_behind(*page_, head_)) {
    page_ = place_page(head_);
    page_world_ = head_world_;
  }
  display_.show_page(*page_);
}

void HeadsetSurface::show_black() {
  if (!page_) return;
  const int slots = std::max(1, static_cast<int>(std::lround(fade_s * display_.measured_hz())));
  for (int left = slots - 1; left >= 0; --left) {
    gui_.dim(static_cast<float>(left) / static_cast<float>(left + 1));
    display_.show_page(*page_);
    take_in(display_.next_records());
  }
  display_.hide_page();
  page_.reset();
  pointer_.reset();
}

/// True if a hand or a controller points, now or within most_hand_waiting_s.
bool has_hands(HeadsetDisplay& display) {
  const int slots = static_cast<int>(most_hand_waiting_s * display.refresh_hz());
  auto records = display.take_records();
  for (int turned = 0; turned < slots; records = display.next_records()) {
    for (const HeadsetRecord& record : records) {
      const auto& aim = record.input.hands.aim;
      if (aim[0] || aim[1]) return true;
      ++turned;
    }
  }
  return false;
}

/// base::Error if the participant has nothing to answer with, because the session would wait for an answer
/// that cannot come.
void require_way(HeadsetDisplay& display, const AnswerWays& ways) {
  if (ways.dwell || (ways.keyboard && isatty(STDIN_FILENO) == 1)) return;
  const bool hands = ways.ray || ways.stick;
  if (hands && has_hands(display)) return;
  const std::string no_hands = hands ? "no controller and no tracked hand is active in the headset" : "";
  const std::string no_keys = ways.keyboard ? "the program was not started in a terminal" : "";
  throw base::Error("--answer", no_hands + (hands && ways.keyboard ? ", and " : "") + no_keys,
                    std::string(hands ? "switch a controller on" : "start it in a terminal") +
                        ", or use --answer dwell: the participant looks at a button for a second");
}

/// Owns the surface and its pages. A shared pointer to either of the two keeps the other alive.
struct HeadsetPages {
  HeadsetPages(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol, const Clock& clock)
      : surface(display, ways, page_characters(protocol)), pages(surface, protocol.language, clock) {}
  HeadsetSurface surface;
  Pages pages;
};

}  // namespace

HeadsetChoice choice_for_person(const AnswerWays& ways) {
  HeadsetChoice choice;
  choice.eye_gaze = ways.dwell;
  choice.page_width_px = page_width_px;
  choice.page_height_px = page_height_px;
  return choice;
}

HeadsetPerson make_headset_person(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol,
                                  const Clock& clock) {
  require_way(display, ways);
  const auto both = std::make_shared<HeadsetPages>(display, ways, protocol, clock);
  const std::shared_ptr<Pages> pages(both, &both->pages);
  HeadsetPerson person;
  person.participant = std::make_unique<PageParticipant>(pages, protocol.blocks.back().id, [] {});
  person.request = [pages](const std::function<Request()>& others) { return pages->request(others); };
  person.idle = [both] { return both->surface.idle_s(); };
  person.listen = [both] { both->surface.listen(); };
  return person;
}

}  // namespace study
