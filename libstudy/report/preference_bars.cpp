#include <algorithm>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::Point;
using svg::text;

constexpr double left = 118, width = 480, right_label = 104, row = 40, bar = 22, top = 62;
constexpr double gap = 8;  ///< distance between a bar and the names beside it, in pixels

double x_of(double share) { return left + width * share; }

/// Draws the confidence interval of a share as a line across its bar.
std::string interval_line(double low, double high, double y) {
  std::string moves = svg::move('M', {x_of(low), y}) + svg::move('L', {x_of(high), y});
  for (const double end : {x_of(low), x_of(high)})
    moves += svg::move('M', {end, y - 5}) + svg::move('L', {end, y + 5});
  return svg::path(moves, "stroke=\"#ffffff\" stroke-width=\"4.5\" fill=\"none\"") +
         svg::path(moves, "stroke=\"#000000\" stroke-width=\"1.8\" fill=\"none\"");
}

/// Stars of the uncorrected test, a slash, and stars after Holm's correction ("n.s." without stars): "** /
/// *". "" if the uncorrected test has no stars.
std::string stars_of(const Field& pair) {
  const std::string plain = pair["stars"].words(), holm = pair["stars_holm"].words();
  if (plain.empty()) return "";
  return plain + " / " + (holm.empty() ? "n.s." : holm);
}

std::string bars(const Field& pair, double y, double stars_end) {
  const Field shown = tested_share(pair);
  const double share = shown.number(), middle = y + bar / 2, base = y + bar / 2 + 5;
  const std::string frame = " stroke=\"#000000\" stroke-width=\"1\"";
  std::string out =
      svg::rectangle({x_of(0), y}, {x_of(share), y + bar}, svg::attribute("fill", svg::colour::sky) + frame) +
      svg::rectangle({x_of(share), y}, {x_of(1), y + bar}, "fill=\"url(#preference-hatch)\"" + frame);
  const Field ci = pair["by_person"].exists() ? pair["by_person"]["ci"] : pair["wilson"];
  if (ci[0].is_number() && ci[1].is_number()) out += interval_line(ci[0].number(), ci[1].number(), middle);
  const std::string halo =
      "font-size=\"13\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\" "
      "stroke=\"#ffffff\" fill=\"#000000\" data-unit=\"%\"";
  out += text({x_of(0) + 6, base}, decimal(100 * share, 0) + " %", halo + data_field(shown));
  return out +
         text({stars_end, base}, stars_of(pair), "text-anchor=\"end\" font-size=\"13\" class=\"stars\"");
}

}  // namespace

svg::Picture preference_bars(const Field& pairs) {
  std::vector<std::string> left_names, right_names;
  for (const Field& pair : pairs.entries()) {
    left_names.push_back(pair["a"].words());
    right_names.push_back(pair["b"].words());
  }
  const double more = std::max(0.0, room_for(left_names) + gap - left);
  const double right_room = std::max(right_label, room_for(right_names) + gap);
  const double end = left + width + right_room + 60;
  svg::Picture picture{.width = more + end, .id = "preference"};
  picture.title = "Which of two methods was preferred";
  picture.description =
      "A bar for each pair of methods: the plain part on the left is the share of answers that chose the "
      "method named on the left, the hatched part the other's. The line across the bar is the share's "
      "interval, the dotted line no preference. The table below holds the same numbers.";
  picture.definitions =
      "<pattern id=\"preference-hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\"><rect "
      "width=\"7\" height=\"7\" fill=\"#fdf3d8\"/><path d=\"M-1,8 L8,-1 M-1,1 L1,-1 M6,8 L8,6\" "
      "stroke=\"#8a5f00\" stroke-width=\"1\"/></pattern>\n";
  double y = top;
  for (const Field& pair : pairs.entries()) {
    const std::string name = "font-size=\"13\"";
    picture.body += text({left - gap, y + bar / 2 + 5}, pair["a"].words(),
                         "text-anchor=\"end\" " + name + data_field(pair["a"]));
    if (pair["share"].is_number()) {
      picture.body += bars(pair, y, end - 4);
    } else {
      picture.body += text({left + 6, y + bar / 2 + 5}, "not given: " + pair["share"].reason(), name);
    }
    picture.body +=
        text({left + width + gap, y + bar / 2 + 5}, pair["b"].words(), name + data_field(pair["b"]));
    y += row;
  }
  const double bottom = y - row + bar + 8;
  for (int i = 0; i <= 4; ++i) {
    const double x = x_of(i / 4.0);
    picture.body += svg::line({x, bottom}, {x, bottom + 6}, "stroke=\"#000000\"") +
                    text({x, bottom + 22}, svg::number(25 * i, 0) + " %",
                         "class=\"axis\" text-anchor=\"middle\" font-size=\"12\"");
  }
  picture.body += svg::line({x_of(0.5), top - 8}, {x_of(0.5), bottom},
                            "stroke=\"#000000\" stroke-width=\"1.5\" stroke-dasharray=\"2 4\"");
  picture.body +=
      text({left, 44}, "plain: the left one was chosen", "font-size=\"12\"") +
      text({left + width, 44}, "hatched: the right one was chosen", "text-anchor=\"end\" font-size=\"12\"") +
      text({end - 4, 44}, "p / Holm", "text-anchor=\"end\" font-size=\"12\"");
  picture.body =
      text({8, 20}, picture.title, "font-size=\"15\" font-weight=\"bold\"") + moved_right(picture.body, more);
  picture.height = bottom + 34;
  return picture;
}

}  // namespace study::report
