#pragma once
/// A page in a headset: drawn on a quad that stands in the world, answered by hand, eyes or keyboard.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/headset/headset_display.hpp"
#include "apps/study/headset/answer_ways.hpp"
#include "apps/study/headset/dwell.hpp"
#include "apps/study/headset/hand_keys.hpp"
#include "apps/study/headset/terminal_keys.hpp"
#include "apps/study/pages/page_surface.hpp"

namespace apps {

/// The pages that the display must have been made for.
HeadsetChoice choice_for_pages(const AnswerWays& ways);

/// A page comes where the head looks, upright, and stays there. It fades to black when it goes. While the
/// headset is not focused nothing is answered. A long press of menu, or Stop on the page, asks whether to
/// stop. Every slot of the display paces it by one picture.
class HeadsetSurface final : public PageSurface {
 public:
  /// display: made with choice_for_pages(); it outlives this.
  HeadsetSurface(HeadsetDisplay& display, const AnswerWays& ways, const PageCharacters& characters = {});

  /// From now on the terminal's keys answer, where the ways have them.
  void listen();
  /// Seconds since a hand or a key was used.
  double idle_s() const;

  Gui& gui() override { return gui_; }
  std::string beginning(const DeskWords& words) const override;
  study::AnswerInput pointer() const override;
  void poll(double wait_s) override;
  std::vector<PageEvent> take_events() override;
  void forget_input() override;
  std::optional<std::pair<std::int64_t, std::int64_t>> take_away() override {
    return std::exchange(away_, std::nullopt);
  }
  void end() override;
  void show() override;
  void show_black() override;
  std::optional<study::CutCause> take_unseen() override { return display_.take_spoilt(); }
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
  std::optional<std::int64_t> last_ns_;  ///< of the slot before
  HeadsetPose head_;                     ///< the last one that was known
  int head_world_ = 0, page_world_ = 0;  ///< in which it was, and the page is
  std::optional<HeadsetPage> page_;      ///< where it stands; none: it is not shown
  Place pointer_;                        ///< px on the page
  Place stick_from_;                     ///< where the pointer was when the stick was pushed: it is put away
  bool pressed_ = false;                 ///< the pointer's button
  int clicks_ = 0;                       ///< pictures until a click of the eyes is over
  std::size_t hand_ = 1;                 ///< that pointed last
  std::int64_t used_ns_;                 ///< steady clock
};

}  // namespace apps
