#pragma once
/// Draws a page: title, text, questions and the button to go on; passes clicks to the page's state.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "libstudy/pages/gui/gui.hpp"
#include "libstudy/pages/gui/pad.hpp"
#include "libstudy/pages/page.hpp"
#include "libstudy/pages/words.hpp"

namespace study {

/// Texts of a page besides its questions.
struct PageText {
  std::string title, text;
  std::string button{};  ///< label of the button to go on; empty: default label
  std::string corner{};  ///< small words in the lower left corner
};

class PageView {
 public:
  /// layer: a name that differs from those of all other open pages. With it, Dear ImGui keeps the scroll
  /// position of a page below a dialog.
  PageView(Gui& gui, const DeskWords& words, PageText text, const char* layer = "body")
      : gui_(gui), words_(words), text_(std::move(text)), layer_(layer) {}

  /// Draws into the current frame of the Gui.
  void draw(PageState& state, std::int64_t now_ns);
  /// Handles a key for the page, or for its on-screen keyboard if one is shown.
  void press(PageState& state, PageKey key, std::int64_t now_ns);
  /// Scrolls a long text by lines; down is positive.
  void scroll(float lines) { scroll_lines_ += lines; }
  /// True if a field has the keyboard focus: letters and Enter then go to the field.
  bool typing(const PageState& state) const;
  /// True if the focused question is answered by typed text (AnswerKind::Text); letters then go to it.
  static bool fills_words(const PageState& state);

 private:
  void draw_body(PageState& state, std::int64_t now_ns);
  void draw_text();
  void draw_questions(PageState& state, std::int64_t now_ns);
  void draw_question(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_scale(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_anchors(const Question& question, float left, float cell);
  void pin_anchors(const Question& question, float left, float cell);
  void draw_line(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_cue(const Question& question);
  void draw_yes_no(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_list(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_number(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_words(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_pad(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_matrix(PageState& state, std::size_t first, std::size_t end, std::int64_t now_ns);
  void draw_footer(PageState& state, std::int64_t now_ns);
  void draw_scroll_buttons(float room);
  void look_at_mouse(bool counts);
  /// True if the last drawn widget is under the pointer. A mouse counts only if it moved since the page
  /// appeared.
  bool hovered() const;
  Pad* pad_of(const PageState& state);
  void follow_focus(const PageState& state, std::size_t i, float top);
  /// Draws a button with a score; true if it was clicked.
  bool score_button(const PageState& state, std::size_t i, int score, const std::string& label, float width,
                    float height, bool left_aligned);
  struct Target {
    const char* kind;  ///< part of the ImGui ID, with row and column
    std::size_t row;
    int column;
    float width, height;
    bool chosen = false, marked = false, left_aligned = false;
  };
  /// Draws a button at ImGui's cursor; true if it was clicked.
  bool target(const Target& what, const std::string& label);

  Gui& gui_;
  const DeskWords& words_;
  PageText text_;
  const char* layer_;
  bool begun_ = false;  ///< the page was drawn before
  /// Lower edge of the anchors pinned above a table, px; -1: none. Rows ignore clicks above this edge.
  float pinned_until_ = -1;
  float column_ = 0;  ///< width of the text column, px
  float height_ = 0;  ///< height of the last drawn content, px
  float scroll_lines_ = 0;
  bool armed_ = false;                 ///< clicks count: the button was up while input was accepted
  bool pointed_ = false;               ///< the mouse moved since the page appeared
  float mouse_x_ = -1, mouse_y_ = -1;  ///< mouse position when the page appeared
  float looked_at_ = -1;  ///< place on the line of a visual analogue scale where the pointer rests, 0 to 1
  std::size_t seen_focus_ = 0;            ///< question to which the page has scrolled
  std::size_t editing_ = ~std::size_t{};  ///< index of the Text question whose edit field is open
  std::string edited_;                    ///< content of this edit field, padded to PageState::most_bytes
  std::optional<Pad> pad_;                ///< on-screen keyboard of pad_question_
  std::size_t pad_question_ = 0;
};

}  // namespace study
