#pragma once
/// Draws a page: title, text, questions and the button to go on; passes clicks to its state.

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
  std::string button{};  ///< label of the button to go on; empty: the default
  std::string corner{};  ///< small, in the lower left corner
};

class PageView {
 public:
  /// layer: unique for each of stacked pages, so that the lower one keeps its scroll position.
  PageView(Gui& gui, const DeskWords& words, PageText text, const char* layer = "body")
      : gui_(gui), words_(words), text_(std::move(text)), layer_(layer) {}

  /// Draws into the current frame of the Gui.
  void draw(PageState& state, std::int64_t now_ns);
  /// Handles a key for the page or the pad that it shows.
  void press(PageState& state, PageKey key, std::int64_t now_ns);
  /// Scrolls a long text by lines; down is positive.
  void scroll(float lines) { scroll_lines_ += lines; }
  /// True if a field has the keyboard, so that letters and Enter go to it.
  bool typing(const PageState& state) const;
  /// True if letters go to the focused question.
  static bool fills_words(const PageState& state);

 private:
  void draw_body(PageState& state, std::int64_t now_ns);
  void draw_text();
  void draw_questions(PageState& state, std::int64_t now_ns);
  void draw_question(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_scale(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_anchors(const Question& question, float left, float cell);
  void pin_anchors(const Question& question, float left, float cell);
  void draw_list(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_number(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_words(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_pad(PageState& state, std::size_t i, std::int64_t now_ns);
  void draw_matrix(PageState& state, std::size_t first, std::size_t end, std::int64_t now_ns);
  void draw_footer(PageState& state, std::int64_t now_ns);
  void draw_scroll_buttons(float room);
  void look_at_mouse(bool counts);
  /// True if the last widget is under a real pointer.
  bool hovered() const;
  Pad* pad_of(const PageState& state);
  void follow_focus(const PageState& state, std::size_t i, float top);
  /// Draws a button with a score; true if it was clicked.
  bool score_button(const PageState& state, std::size_t i, int score, const std::string& label, float width,
                    float height, bool left_aligned);
  struct Target {
    const char* kind;  ///< forms its name with row and column
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
  float pinned_until_ =
      -1;             ///< lower edge of the words pinned above a table, px; rows ignore clicks above it
  float column_ = 0;  ///< width of the text, px
  float height_ = 0;  ///< of the last drawn content, px
  float scroll_lines_ = 0;
  bool armed_ = false;                    ///< the mouse button was up since input is accepted
  bool pointed_ = false;                  ///< the mouse moved since the page appeared
  float mouse_x_ = -1, mouse_y_ = -1;     ///< its position when the page appeared
  std::size_t seen_focus_ = 0;            ///< the focus to which the page has scrolled
  std::size_t editing_ = ~std::size_t{};  ///< Text whose field has the keyboard
  std::string edited_;                    ///< its content, with room to grow
  std::optional<Pad> pad_;                ///< of the focused question
  std::size_t pad_question_ = 0;
};

}  // namespace study
