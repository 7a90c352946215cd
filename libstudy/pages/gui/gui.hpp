#pragma once
/// Dear ImGui on any framebuffer: large type on dark grey, and custom widgets instead of the small ones of
/// Dear ImGui.

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "libstudy/pages/gui/page_fonts.hpp"

struct ImFont;
struct ImGuiContext;
struct ImVec2;

namespace study {

/// Colours of the pages in Dear ImGui's packed form.
namespace colour {
extern const unsigned background, panel, button, hovered, chosen, text, dim, faint, warning, black;
}

/// Heights of the fonts, px from the highest ascent to the lowest descent.
struct TypeSizes {
  float body = 0, title = 0, huge = 0;
};
/// Font heights for a screen at arm's length: fixed fractions of the screen's height, within limits in px.
TypeSizes type_for_screen(int height_px);
/// Font heights with which the letter x of body text has at least the height x_height_px.
TypeSizes type_for_x_height(float x_height_px);

class Gui {
 public:
  /// The surface on which the pages are drawn, and its input.
  struct Host {
    /// Called before each picture. Writes size, pointer and typed keys to Dear ImGui's ImGuiIO.
    std::function<void()> look;
    std::function<unsigned()> framebuffer;  ///< OpenGL framebuffer object for the next picture
    /// True if the participant has no keyboard or mouse: the page then shows keys, arrows and a stop button.
    bool by_hand = false;
  };

  /// An OpenGL context must be current here and in each later call. characters: all characters that the pages
  /// will draw.
  Gui(const TypeSizes& type, Host host, const PageCharacters& characters = {});
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Clears the framebuffer to a colour and begins a picture, which end() draws.
  void begin(unsigned clear_colour);
  void end();
  /// Draws the last picture again, with all colours multiplied by `share`, 0 to 1. Repeated calls multiply:
  /// two calls with 0.5 give a quarter.
  void dim(float share);

  ImFont* body() const { return body_; }
  ImFont* title() const { return title_; }
  ImFont* huge() const { return huge_; }      ///< only characters U+0020 to U+003A, for digits and colon
  float size_px() const { return size_px_; }  ///< of body text
  float x_height_px() const;                  ///< of body text
  bool by_hand() const { return host_.by_hand; }

  /// Call while a picture is drawn: point_at() for the target under the pointer, wish_stop() for a click on
  /// Stop.
  void point_at(unsigned target) { pointed_at_ = target; }
  void wish_stop() { stop_ = true; }
  /// ImGui ID of the target (button) under the pointer in the last picture; 0: none.
  unsigned pointed_at() const { return pointed_at_; }
  bool take_stop() { return std::exchange(stop_, false); }

 private:
  void clear() const;

  Host host_;
  ImGuiContext* context_ = nullptr;
  ImFont *body_ = nullptr, *title_ = nullptr, *huge_ = nullptr;
  float size_px_ = 0;
  std::array<float, 3> clear_{};  ///< colour, 0 to 1
  unsigned pointed_at_ = 0;
  bool stop_ = false;
};

/// Draws words at Dear ImGui's cursor, wrapped at the current wrap position.
void draw_wrapped(const std::string& words, unsigned colour);

/// Draws words centred at top_centre.x, wrapped to a width, from top_centre.y down; returns the y below the
/// words.
float draw_centred(const std::string& words, ImVec2 top_centre, float width, unsigned colour);

/// Texts of a pause: a title of one line, and paragraphs separated by empty lines. Either may be empty.
struct PauseWords {
  std::string title, text;
  bool none() const { return title.empty() && text.empty(); }
};

/// Draws small words about how to stop in the lower left corner of the current ImGui window. With by_hand()
/// the words are a button.
void draw_corner(Gui& gui, const std::string& words);

/// Draws the words and the time left (minutes, seconds) in the middle of the window, with small digits if the
/// text is long.
void draw_countdown(Gui& gui, const PauseWords& words, int left_s, const std::string& corner);
/// Draws only the words, in the middle of the window.
void draw_words(Gui& gui, const PauseWords& words, const std::string& corner);

}  // namespace study
