#pragma once
/// Pieces of SVG as text: what the figures of all programs share.

#include <string>
#include <string_view>

namespace apps::svg {

/// A place in pixels, y downwards.
struct Point {
  double x = 0, y = 0;
};

/// Okabe and Ito's colours (2008): told apart with any common colour vision. Figures never rely on colour
/// alone.
namespace colour {
inline constexpr const char* orange = "#e69f00";
inline constexpr const char* sky = "#56b4e9";
inline constexpr const char* green = "#009e73";
inline constexpr const char* yellow = "#f0e442";
inline constexpr const char* blue = "#0072b2";
inline constexpr const char* vermilion = "#d55e00";
inline constexpr const char* purple = "#cc79a7";
inline constexpr const char* grey = "#999999";
}  // namespace colour

/// `value` with a fixed number of digits behind the point; never "-0.00".
std::string number(double value, int decimals = 2);
/// Free text as it may stand between tags and in attributes, here and in HTML. Control characters, which XML
/// does not know, become spaces.
std::string escaped(std::string_view raw);
/// ` name="value"`, escaped, to be joined with others.
std::string attribute(std::string_view name, std::string_view value);

/// Elements; `attributes` are further ones, as written. `words` are escaped here.
std::string text(Point at, std::string_view words, const std::string& attributes = "");
/// The same with markup inside, such as tspans, as written.
std::string marked_text(Point at, const std::string& markup, const std::string& attributes = "");
std::string line(Point from, Point to, const std::string& attributes);
/// Corners in any order of left, right and top, bottom.
std::string rectangle(Point corner, Point opposite, const std::string& attributes);
std::string circle(Point centre, double radius, const std::string& attributes);
std::string path(const std::string& moves, const std::string& attributes);
/// "M" or "L" with a place, for path().
std::string move(char command, Point to);
/// An X of the given half width.
std::string cross(Point centre, double reach, const std::string& attributes);

/// A whole picture. `id` stands before the ids inside it, so that several may share a page.
struct Picture {
  double width = 0, height = 0;
  std::string id = {};
  std::string title = {};        ///< in a word, read aloud first
  std::string description = {};  ///< what is to be seen, for those who do not see it
  std::string definitions = {};  ///< patterns and clip paths
  std::string body = {};
};
/// As an element of an HTML page, which needs no namespace.
std::string element(const Picture& picture);
/// As a file of its own.
std::string document(const Picture& picture);

}  // namespace apps::svg
