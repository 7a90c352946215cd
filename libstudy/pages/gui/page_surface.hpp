#pragma once
/// Interface of a surface that shows pages and reads input: a window, or a page in a headset.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/display/cut_cause.hpp"
#include "libstudy/pages/gui/gui.hpp"
#include "libstudy/pages/page.hpp"
#include "libstudy/pages/words.hpp"

namespace study {

/// One input event of a participant. Dear ImGui handles the pointer.
struct PageEvent {
  std::optional<PageKey> key{};
  int digit = -1;
  bool minus = false;
  bool stop = false;       ///< true: opens the stop dialog
  bool pressed = false;    ///< true: a key, button or trigger went down; answers a question of kind Reaction
  float lines = 0;         ///< number of lines to scroll down
  bool text_only = false;  ///< true: `lines` applies only to pages without questions
  /// Input device. While a field has the keyboard focus, a keyboard event is ignored unless it leaves the
  /// field or opens the stop dialog.
  AnswerInput input = AnswerInput::Keyboard;
  /// Typed letters. A window reports them in lower case, and also passes them to Dear ImGui.
  std::string letters{};
};

/// A surface that shows pages and reads input. All calls come from the session's thread.
class PageSurface {
 public:
  virtual ~PageSurface() = default;
  virtual Gui& gui() = 0;
  /// Text about how to answer and how to stop, for the first page of a session.
  virtual std::string beginning(const DeskWords& words) const { return words.begin; }

  /// Input device that moves the pointer.
  virtual AnswerInput pointer() const { return AnswerInput::Mouse; }

  /// Waits for input for about wait_s seconds and processes the input. base::Error if the surface is gone.
  virtual void poll(double wait_s) = 0;
  /// Returns the events since the last call.
  virtual std::vector<PageEvent> take_events() = 0;
  virtual void forget_input() = 0;
  /// A period (begin, end; ns on the session's clock) in which the participant could not answer; none if no
  /// such period ended since the last call.
  virtual std::optional<std::pair<std::int64_t, std::int64_t>> take_away() { return {}; }

  virtual void begin(unsigned clear_colour) { gui().begin(clear_colour); }
  /// Finishes the picture of begin(); show() then presents the picture.
  virtual void end() { gui().end(); }
  virtual void show() = 0;
  /// Presents black now.
  virtual void show_black() = 0;
  virtual void show_cursor(bool /*shown*/) {}

  /// The cause for which the picture could not be seen at some time since the last call; none if it could
  /// always be seen.
  virtual std::optional<CutCause> take_unseen() = 0;
  /// True if the picture cannot be seen now.
  virtual bool unseen() const { return false; }
  /// Call it when the session is over (true) or another session begins (false). After `true`, closing the
  /// surface is no error.
  virtual void set_over(bool /*over*/) {}
};

}  // namespace study
