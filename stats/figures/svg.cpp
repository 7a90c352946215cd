#include "stats/figures/svg.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

namespace svg {

namespace {

std::string place(Point p) { return number(p.x) + "," + number(p.y); }

std::string attributes_of(const std::string& attributes) {
  return attributes.empty() || attributes.front() == ' ' ? attributes : " " + attributes;
}

std::string drawn(const Picture& picture, const std::string& space, const std::string& background) {
  const std::string title = picture.id + "-title", description = picture.id + "-description";
  const std::string width = number(picture.width, 0), height = number(picture.height, 0);
  return "<svg" + space + attribute("viewBox", "0 0 " + width + " " + height) + attribute("width", width) +
         attribute("height", height) + " role=\"img\"" +
         attribute("aria-labelledby", title + " " + description) +
         " font-family=\"DejaVu Sans, Arial, sans-serif\">\n<title" + attribute("id", title) + ">" +
         escaped(picture.title) + "</title>\n<desc" + attribute("id", description) + ">" +
         escaped(picture.description) + "</desc>\n" +
         (picture.definitions.empty() ? "" : "<defs>\n" + picture.definitions + "</defs>\n") + background +
         picture.body + "</svg>\n";
}

}  // namespace

std::string number(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, std::clamp(decimals, 0, 17));
  if (out.front() == '-' && out.find_first_of("123456789ni") == std::string::npos) out.erase(0, 1);
  return out;
}

std::string escaped(std::string_view raw) {
  std::string out;
  for (const char c : raw) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
        out += c;
        break;
      default:
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return out;
}

std::string attribute(std::string_view name, std::string_view value) {
  return " " + std::string(name) + "=\"" + escaped(value) + "\"";
}

std::string text(Point at, std::string_view words, const std::string& attributes) {
  return marked_text(at, escaped(words), attributes);
}

std::string marked_text(Point at, const std::string& markup, const std::string& attributes) {
  return "<text x=\"" + number(at.x) + "\" y=\"" + number(at.y) + "\"" + attributes_of(attributes) + ">" +
         markup + "</text>\n";
}

std::string line(Point from, Point to, const std::string& attributes) {
  return path(move('M', from) + " " + move('L', to), attributes);
}

std::string rectangle(Point corner, Point opposite, const std::string& attributes) {
  const Point low{std::min(corner.x, opposite.x), std::min(corner.y, opposite.y)};
  return "<rect x=\"" + number(low.x) + "\" y=\"" + number(low.y) + "\" width=\"" +
         number(std::abs(opposite.x - corner.x)) + "\" height=\"" + number(std::abs(opposite.y - corner.y)) +
         "\"" + attributes_of(attributes) + "/>\n";
}

std::string circle(Point centre, double radius, const std::string& attributes) {
  return "<circle cx=\"" + number(centre.x) + "\" cy=\"" + number(centre.y) + "\" r=\"" + number(radius) +
         "\"" + attributes_of(attributes) + "/>\n";
}

std::string path(const std::string& moves, const std::string& attributes) {
  return "<path d=\"" + moves + "\"" + attributes_of(attributes) + "/>\n";
}

std::string move(char command, Point to) { return command + place(to); }

std::string cross(Point centre, double reach, const std::string& attributes) {
  const auto at = [&](double x, double y) { return Point{centre.x + x * reach, centre.y + y * reach}; };
  return path(move('M', at(-1, -1)) + move('L', at(1, 1)) + move('M', at(-1, 1)) + move('L', at(1, -1)),
              attributes);
}

// Without a background rectangle, which would cover the shading by which the HTML page shows that there is
// more to scroll to.
std::string element(const Picture& picture) { return drawn(picture, "", ""); }

std::string document(const Picture& picture) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
         drawn(picture, " xmlns=\"http://www.w3.org/2000/svg\"",
               rectangle({0, 0}, {picture.width, picture.height}, "fill=\"#ffffff\""));
}

}  // namespace svg
