#pragma once
/// Parts of SVG as text, shared by the figures of all programs.

#include <string>
#include <string_view>

namespace svg {

/// A point in pixels, y downwards.
struct Point {
  double x = 0, y = 0;
};

/// Seven colours of Okabe and Ito (2008), which people with common forms of colour blindness can distinguish,
/// and a grey of our own.
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

/// `value` with a fixed number of decimals; never "-0.00".
std::string number(double value, int decimals = 2);
/// Escapes free text for use between tags and in attributes, in SVG and in HTML. Control characters other
/// than line feed become spaces, because XML forbids most of them.
std::string escaped(std::string_view raw);
/// The text ` name="value"` with the value escaped; several such texts can be concatenated.
std::string attribute(std::string_view name, std::string_view value);

/// A <text> element. `words` are escaped. `attributes` are inserted as written, here and in the functions
/// below.
std::string text(Point at, std::string_view words, const std::string& attributes = "");
/// A <text> element whose content, such as tspans, is inserted as written.
std::string marked_text(Point at, const std::string& markup, const std::string& attributes = "");
std::string line(Point from, Point to, const std::string& attributes);
/// `corner` and `opposite` are any two opposite corners.
std::string rectangle(Point corner, Point opposite, const std::string& attributes);
std::string circle(Point centre, double radius, const std::string& attributes);
std::string path(const std::string& moves, const std::string& attributes);
/// "M" or "L" with a point, for path().
std::string move(char command, Point to);
/// An X that extends `reach` px from its centre along x and y.
std::string cross(Point centre, double reach, const std::string& attributes);

/// A whole picture. `id` is the prefix of the ids inside it, so that several pictures can share a page.
struct Picture {
  double width = 0, height = 0;
  std::string id = {};
  std::string title = {};        ///< names the picture in a few words; screen readers read it first
  std::string description = {};  ///< describes the picture for readers who cannot see it
  std::string definitions = {};  ///< patterns and clip paths
  std::string body = {};
};
/// The picture as an <svg> element for an HTML page, which needs no XML namespace.
std::string element(const Picture& picture);
/// The picture as the text of an SVG file, with a white background.
std::string document(const Picture& picture);

}  // namespace svg
