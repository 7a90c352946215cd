#pragma once
/// A page in a headset: drawn on a quad fixed in the world, answered by hand, eyes or keyboard.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/headset/headset_display.hpp"
#include "libstudy/pages/gui/page_surface.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/pages/headset/dwell.hpp"
#include "libstudy/pages/headset/hand_keys.hpp"
#include "libstudy/pages/headset/terminal_keys.hpp"

namespace study {

/// The choice with which the display must be made.
HeadsetChoice choice_for_pages(const AnswerWays& ways);

/// A page appears upright where the head looks, and stays there. It fades to black when it ends. Input is
/// ignored while the headset is not focused. A long press of menu, or Stop on the page, opens the stop
/// dialog. It draws one picture per slot of the display.
class HeadsetSurface final : public PageSurface {
 public:
  /// display: made with choice_for_pages(); it must outlive this.
  HeadsetSurface(HeadsetDisplay& display, const AnswerWays& ways, const PageCharacters& characters = {});

  /// Makes the terminal's keys answer from now on, if the ways include the keyboard.
  void listen();
  /// Seconds since a hand or a key was used.
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
  std::optional<CutCause> take_unseen() override { return display_.take_spoilt(); }
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
  std::optional<std::int64_t> last_ns_;  ///< of the previous slot
  HeadsetPose head_;                     ///< the last known pose
  int head_world_ = 0, page_world_ = 0;  ///< worlds of head_ and of the page
  std::optional<HeadsetPage> page_;      ///< the shown page; none: not shown
  Place pointer_;                        ///< px on the page
  Place stick_from_;      ///< pointer position when the stick was pushed, which hides the pointer
  bool pressed_ = false;  ///< the pointer's button
  int clicks_ = 0;        ///< pictures until a click by dwell is over
  std::size_t hand_ = 1;  ///< the hand that pointed last
  std::int64_t used_ns_;  ///< steady clock
};

}  // namespace study
