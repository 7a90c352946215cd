#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::text;

constexpr double left = 190, width = 330, row = 24, bar = 18, top = 70;

/// Colour of a score: from blue for the lowest through light grey to orange for the highest. The colours are
/// distinguishable with all common types of colour vision. In greyscale, scores on each side of the middle
/// differ in lightness.
struct Shade {
  std::array<double, 3> rgb{};
  std::string fill() const {
    return fmt::format("#{:02x}{:02x}{:02x}", int(std::lround(rgb[0])), int(std::lround(rgb[1])),
                       int(std::lround(rgb[2])));
  }
  const char* ink() const {
    return 0.30 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2] > 130 ? "#000000" : "#ffffff";
  }
};

Shade shade(std::size_t i, std::size_t n) {
  constexpr std::array low{0.0, 82.0, 136.0}, middle{236.0, 236.0, 236.0}, high{230.0, 133.0, 0.0};
  const double at = n < 2 ? 0.5 : static_cast<double>(i) / static_cast<double>(n - 1);
  const auto& end = at < 0.5 ? low : high;
  const double towards = std::abs(2 * at - 1);
  Shade out;
  for (std::size_t c = 0; c < 3; ++c) out.rgb[c] = middle[c] + towards * (end[c] - middle[c]);
  return out;
}

std::string legend(const std::vector<Field>& counts) {
  std::string out = text({left - 8, 52}, "score", "text-anchor=\"end\" font-size=\"13\"");
  const double each = std::min(56.0, width / static_cast<double>(counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = left + each * static_cast<double>(i);
    const Shade colour = shade(i, counts.size());
    out +=
        svg::rectangle({x, 38}, {x + each - 4, 58},
                       svg::attribute("fill", colour.fill()) + " stroke=\"#000000\" stroke-width=\"0.6\"") +
        text({x + each / 2 - 2, 53}, svg::number(counts[i]["score"].number(), 0),
             "text-anchor=\"middle\" font-size=\"13\"" + svg::attribute("fill", colour.ink()) +
                 data_field(counts[i]["score"]));
  }
  return out;
}

std::string drawn(const Field& entry, const std::string& name, double y) {
  std::string out = text({left - 8, y + 14}, name, "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
  const auto counts = entry["counts"].entries();
  double before = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double n = counts[i]["n"].number();
    if (n <= 0) continue;
    const double from = left + width * before / entry["n"].number();
    before += n;
    const double to = left + width * before / entry["n"].number();
    const Shade colour = shade(i, counts.size());
    out += svg::rectangle({from, y}, {to, y + bar},
                          svg::attribute("fill", colour.fill()) + " stroke=\"#000000\" stroke-width=\"0.6\"");
    if (to - from >= 9 * std::ceil(std::log10(n + 1)))
      out += text({(from + to) / 2, y + 14}, svg::number(n, 0),
                  "text-anchor=\"middle\" font-size=\"13\"" + svg::attribute("fill", colour.ink()) +
                      data_field(counts[i]["n"]));
  }
  return out;
}

}  // namespace

svg::Picture rating_bars(const std::vector<Field>& entries, const std::vector<std::string>& names,
                         const std::string& id, const std::string& title) {
  // The left margin is only as wide as the longest name needs, so that a picture with short names fits a
  // narrow screen.
  const double more = std::max(room_for(names), room_for({"score"})) + 8 - left;
  svg::Picture picture{.width = more + left + width + 20, .id = id};
  picture.title = title;
  picture.description =
      "A bar for each line of names: the shares of its answers that gave each score, from the lowest at the "
      "left to "
      "the highest at the right, with how many they were.";
  double y = top;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    picture.body += drawn(entries[i], names[i], y);
    y += row;
  }
  for (int i = 0; i <= 4; ++i) {
    const double x = left + width * i / 4.0;
    picture.body += svg::line({x, y}, {x, y + 6}, "stroke=\"#000000\"") +
                    text({x, y + 22}, svg::number(25 * i, 0) + " %",
                         "class=\"axis\" text-anchor=\"middle\" font-size=\"12\"");
  }
  if (!entries.empty()) picture.body += legend(entries.front()["counts"].entries());
  picture.body =
      text({8, 20}, title, "font-size=\"15\" font-weight=\"bold\"") + moved_right(picture.body, more);
  picture.height = y + 34;
  return picture;
}

}  // namespace study::report
