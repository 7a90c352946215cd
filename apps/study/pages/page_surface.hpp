#pragma once
/// Where pages are shown, and from where they are answered: a window, or a page in a headset.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/desk/page.hpp"
#include "apps/study/desk/words.hpp"
#include "apps/study/pages/gui.hpp"
#include "libstudy/display/cut_cause.hpp"

namespace apps {

/// What came from a participant beside the pointer, of which Dear ImGui hears.
struct PageEvent {
  std::optional<PageKey> key{};
  int digit = -1;
  bool minus = false;
  bool stop = false;       ///< asks whether to stop
  float lines = 0;         ///< scrolls down by so many
  bool text_only = false;  ///< it scrolls a text without questions alone
  /// Those of the keyboard go to the field that has it, unless they leave the field.
  study::AnswerInput input = study::AnswerInput::Keyboard;
  std::string letters{};  ///< where the surface types into fields by itself
};

/// All calls on one thread, the session's.
class PageSurface {
 public:
  virtual ~PageSurface() = default;
  virtual Gui& gui() = 0;
  /// What the first page of a session says on how to answer and to stop.
  virtual std::string beginning(const DeskWords& words) const { return words.begin; }

  /// What the pointer is moved by.
  virtual study::AnswerInput pointer() const { return study::AnswerInput::Mouse; }

  /// Takes in what happened, waiting about wait_s for it. base::Error when the surface is gone.
  virtual void poll(double wait_s) = 0;
  /// What came since the last call.
  virtual std::vector<PageEvent> take_events() = 0;
  virtual void forget_input() = 0;
  /// From when to when nobody could answer, on the session's clock: over since the last call.
  virtual std::optional<std::pair<std::int64_t, std::int64_t>> take_away() { return {}; }

  virtual void begin(unsigned clear_colour) { gui().begin(clear_colour); }
  /// Draws what was begun; show() then hands it over.
  virtual void end() { gui().end(); }
  virtual void show() = 0;
  /// Black, handed over now.
  virtual void show_black() = 0;
  virtual void show_cursor(bool /*shown*/) {}

  /// Why what was shown could not be seen at some time since the last call; none: it was seen.
  virtual std::optional<study::CutCause> take_unseen() = 0;
  /// Whether it cannot be seen now.
  virtual bool unseen() const { return false; }
  /// The session is over, or another one begins: over, who leaves just leaves.
  virtual void set_over(bool /*over*/) {}
};

}  // namespace apps
