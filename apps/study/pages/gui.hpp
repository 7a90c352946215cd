#pragma once
/// Dear ImGui on any framebuffer: large type, dark grey, drawn by hand where the usual widgets are too small.

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "apps/study/pages/page_fonts.hpp"

struct ImFont;
struct ImGuiContext;
struct ImVec2;

namespace apps {

/// Grey levels and the accent, as ImGui's packed colours.
namespace colour {
extern const unsigned background, panel, button, hovered, chosen, text, dim, faint, warning, black;
}

/// Heights of the type, px from the highest ascent to the lowest descent.
struct TypeSizes {
  float body = 0, title = 0, huge = 0;
};
/// For a screen at an arm's length, of which the type takes a fixed share.
TypeSizes type_for_screen(int height_px);
/// For a body whose letter x is at least so high.
TypeSizes type_for_x_height(float x_height_px);

class Gui {
 public:
  /// Where pictures are drawn and who points at them.
  struct Host {
    /// Called before each picture: tells ImGui's IO the size, the pointer and what was typed.
    std::function<void()> look;
    std::function<unsigned()> framebuffer;  ///< asked for each picture
    /// There is nothing but the page to answer with: it shows its own keys, arrows and the way to stop.
    bool by_hand = false;
  };

  /// Needs a current OpenGL context, now and in each call. characters: those of the pages to come.
  Gui(const TypeSizes& type, Host host, const PageCharacters& characters = {});
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Clears the framebuffer to a colour and begins a picture; end() draws it.
  void begin(unsigned clear_colour);
  void end();
  /// Draws the last picture again, its colours times a share of 1.
  void dim(float share);

  ImFont* body() const { return body_; }
  ImFont* title() const { return title_; }
  ImFont* huge() const { return huge_; }      ///< digits only
  float size_px() const { return size_px_; }  ///< of the body
  float x_height_px() const;                  ///< of the body
  bool by_hand() const { return host_.by_hand; }

  /// Told while a picture is drawn: the pointer is on this target, or the one to stop was clicked.
  void point_at(unsigned target) { pointed_at_ = target; }
  void wish_stop() { stop_ = true; }
  /// What the pointer was on in the last picture; 0: on nothing that can be chosen.
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

/// Words at ImGui's cursor, wrapped at its position for that.
void draw_wrapped(const std::string& words, unsigned colour);

/// Words centred about x, wrapped to a width, from y down; returns the y below them.
float draw_centred(const std::string& words, ImVec2 top_centre, float width, unsigned colour);

/// What stands with a countdown: a line, and a text of paragraphs parted by empty lines. Either may be empty.
struct PauseWords {
  std::string title, text;
  bool none() const { return title.empty() && text.empty(); }
};

/// Small words in the lower left corner of the current ImGui window; how to stop. Where one answers by hand
/// they are a button.
void draw_corner(Gui& gui, const std::string& words);

/// The words and the minutes and seconds left, in the middle of the window; small digits make room for a long
/// text.
void draw_countdown(Gui& gui, const PauseWords& words, int left_s, const std::string& corner);
/// The words alone.
void draw_words(Gui& gui, const PauseWords& words, const std::string& corner);

}  // namespace apps
