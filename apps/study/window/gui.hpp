#pragma once
/// Dear ImGui on a participant's window: large type, dark grey, drawn by hand where the usual widgets are too
/// small.

#include <string>

struct GLFWwindow;
struct ImFont;
struct ImGuiContext;
struct ImVec2;

namespace apps {

/// A font of the system, or "" where none is found (Dear ImGui's own is then used). $VIP_FONT wins.
std::string find_font();

/// Grey levels and the accent, as ImGui's packed colours.
namespace colour {
extern const unsigned background, panel, button, hovered, chosen, text, dim, faint, warning;
}

class Gui {
 public:
  /// height_px: of the window; the type is a fixed share of it.
  Gui(GLFWwindow* window, int height_px);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Clears the window to a colour and begins a frame; end() draws it. Swapping is the caller's.
  void begin(unsigned clear_colour);
  void end();

  ImFont* body() const { return body_; }
  ImFont* title() const { return title_; }
  ImFont* huge() const { return huge_; }      ///< digits only
  float size_px() const { return size_px_; }  ///< of the body

 private:
  ImGuiContext* context_ = nullptr;
  ImFont *body_ = nullptr, *title_ = nullptr, *huge_ = nullptr;
  float size_px_ = 0;
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

/// Small words in the lower left corner of the current ImGui window.
void draw_corner(const Gui& gui, const std::string& words);

/// The words and the minutes and seconds left, in the middle of the window; small digits make room for a long
/// text.
void draw_countdown(const Gui& gui, const PauseWords& words, int left_s, const std::string& corner);
/// The words alone.
void draw_words(const Gui& gui, const PauseWords& words, const std::string& corner);

}  // namespace apps
