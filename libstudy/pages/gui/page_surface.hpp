#pragma once
/// Interface for showing pages and reading input: a window, or a page in a headset.

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

/// Input of a participant except for the pointer, which Dear ImGui handles.
struct PageEvent {
  std::optional<PageKey> key{};
  int digit = -1;
  bool minus = false;
  bool stop = false;       ///< opens the stop dialog
  float lines = 0;         ///< number of lines to scroll down
  bool text_only = false;  ///< scrolls only a text without questions
  /// Keyboard events go to the field with the keyboard focus, unless they leave the field.
  AnswerInput input = AnswerInput::Keyboard;
  std::string letters{};  ///< if the surface itself types into fields
};

/// All calls come from the session's thread.
class PageSurface {
 public:
  virtual ~PageSurface() = default;
  virtual Gui& gui() = 0;
  /// Text of a session's first page on how to answer and to stop.
  virtual std::string beginning(const DeskWords& words) const { return words.begin; }

  /// Input device that moves the pointer.
  virtual AnswerInput pointer() const { return AnswerInput::Mouse; }

  /// Processes input, waiting about wait_s for it. base::Error if the surface is gone.
  virtual void poll(double wait_s) = 0;
  /// Returns the events since the last call.
  virtual std::vector<PageEvent> take_events() = 0;
  virtual void forget_input() = 0;
  /// A period, ended since the last call, in which no answer was possible, on the session's clock.
  virtual std::optional<std::pair<std::int64_t, std::int64_t>> take_away() { return {}; }

  virtual void begin(unsigned clear_colour) { gui().begin(clear_colour); }
  /// Finishes the picture that was begun; show() then presents it.
  virtual void end() { gui().end(); }
  virtual void show() = 0;
  /// Presents black now.
  virtual void show_black() = 0;
  virtual void show_cursor(bool /*shown*/) {}

  /// Why the picture could not be seen at some time since the last call; none: it was seen.
  virtual std::optional<CutCause> take_unseen() = 0;
  /// True if the picture cannot be seen now.
  virtual bool unseen() const { return false; }
  /// The session is over (true) or another one begins (false). Once over, closing the surface is no error.
  virtual void set_over(bool /*over*/) {}
};

}  // namespace study
