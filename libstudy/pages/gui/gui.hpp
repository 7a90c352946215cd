#pragma once
/// Dear ImGui on any framebuffer: large type, dark grey, custom widgets where the usual ones are too small.

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "libstudy/pages/gui/page_fonts.hpp"

struct ImFont;
struct ImGuiContext;
struct ImVec2;

namespace study {

/// Grey levels and the accent, as ImGui's packed colours.
namespace colour {
extern const unsigned background, panel, button, hovered, chosen, text, dim, faint, warning, black;
}

/// Heights of the type, px from the highest ascent to the lowest descent.
struct TypeSizes {
  float body = 0, title = 0, huge = 0;
};
/// For a screen at arm's length: type sizes are a fixed fraction of its height.
TypeSizes type_for_screen(int height_px);
/// For body text whose letter x has at least this height.
TypeSizes type_for_x_height(float x_height_px);

class Gui {
 public:
  /// Target of the pictures and source of the pointer.
  struct Host {
    /// Called before each picture: tells ImGui's IO the size, the pointer and what was typed.
    std::function<void()> look;
    std::function<unsigned()> framebuffer;  ///< called for each picture
    /// Answers come only through the page, so the page shows its own keys, arrows and stop button.
    bool by_hand = false;
  };

  /// Needs a current OpenGL context, now and in each call. characters: all characters of later pages.
  Gui(const TypeSizes& type, Host host, const PageCharacters& characters = {});
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Clears the framebuffer to a colour and begins a picture; end() draws it.
  void begin(unsigned clear_colour);
  void end();
  /// Redraws the last picture with colours multiplied by `share`, 0 to 1.
  void dim(float share);

  ImFont* body() const { return body_; }
  ImFont* title() const { return title_; }
  ImFont* huge() const { return huge_; }      ///< digits only
  float size_px() const { return size_px_; }  ///< of the body
  float x_height_px() const;                  ///< of the body
  bool by_hand() const { return host_.by_hand; }

  /// Set while a picture is drawn: the target under the pointer; a click on Stop.
  void point_at(unsigned target) { pointed_at_ = target; }
  void wish_stop() { stop_ = true; }
  /// The target under the pointer in the last picture; 0: none.
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

/// Draws words at ImGui's cursor, wrapped at its wrap position.
void draw_wrapped(const std::string& words, unsigned colour);

/// Draws words centred about x, wrapped to a width, from y down; returns the y below them.
float draw_centred(const std::string& words, ImVec2 top_centre, float width, unsigned colour);

/// Texts shown with a countdown: a line, and paragraphs separated by empty lines. Either may be empty.
struct PauseWords {
  std::string title, text;
  bool none() const { return title.empty() && text.empty(); }
};

/// Draws small words in the lower left corner of the current ImGui window: how to stop. With by_hand() they
/// are a button.
void draw_corner(Gui& gui, const std::string& words);

/// Draws the words and the time left (minutes, seconds) in the middle of the window, with small digits if the
/// text is long.
void draw_countdown(Gui& gui, const PauseWords& words, int left_s, const std::string& corner);
/// Draws only the words.
void draw_words(Gui& gui, const PauseWords& words, const std::string& corner);

}  // namespace study
