#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::line;
using svg::Point;
using svg::text;

constexpr double left = 52, top = 40, width = 560, plot_height = 220, scale_max = 20;

double y_of(double score) { return top + plot_height * (1 - score / scale_max); }

/// Horizontal positions, in pixels, of the `n` times of asking.
struct Places {
  std::size_t n = 1;
  double x(std::size_t i) const {
    return left + width * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
  }
};

std::string band(const std::vector<Field>& times, const Places& places) {
  std::string moves;
  for (std::size_t i = 0; i < times.size(); ++i)
    moves += svg::move(i == 0 ? 'M' : 'L', {places.x(i), y_of(times[i]["q3"].number())}) + " ";
  for (std::size_t i = times.size(); i-- > 0;)
    moves += svg::move('L', {places.x(i), y_of(times[i]["q1"].number())}) + " ";
  return svg::path(moves + "Z",
                   svg::attribute("fill", svg::colour::sky) + " fill-opacity=\"0.45\" stroke=\"none\"");
}

std::string median(const std::vector<Field>& times, const Places& places) {
  std::string moves;
  for (std::size_t i = 0; i < times.size(); ++i)
    moves += svg::move(i == 0 ? 'M' : 'L', {places.x(i), y_of(times[i]["median"].number())}) + " ";
  return svg::path(moves, svg::attribute("stroke", svg::colour::blue) + " stroke-width=\"2\" fill=\"none\"");
}

std::string axes(const Places& places, std::size_t n) {
  std::string out;
  for (int score = 0; score <= scale_max; score += 5) {
    out +=
        line({left, y_of(score)}, {left + width, y_of(score)}, "stroke=\"#000000\" stroke-opacity=\"0.25\"") +
        text({left - 8, y_of(score) + 5}, svg::number(score, 0),
             "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
  }
  for (std::size_t i = 0; i < n; ++i)
    out += text({places.x(i), y_of(0) + 20}, svg::number(static_cast<double>(i + 1), 0),
                "class=\"axis\" text-anchor=\"middle\" font-size=\"13\"");
  return out + text({left + width / 2, y_of(0) + 42}, "asking", "text-anchor=\"middle\" font-size=\"13\"");
}

}  // namespace

svg::Picture fms_chart(const Field& fms, const std::string& id) {
  const auto times = fms["times"].entries();
  const Places places{times.size()};
  svg::Picture picture{.width = left + width + 12, .height = y_of(0) + 54, .id = id};
  picture.title = "Fast Motion Sickness scale over the session";
  picture.description =
      "Quartiles, median, mean and largest score of all sessions at each asking. The table below holds the "
      "numbers.";
  picture.body = text({8, 20}, picture.title, "font-size=\"15\" font-weight=\"bold\"") +
                 axes(places, times.size()) + band(times, places) + median(times, places);
  for (std::size_t i = 0; i < times.size(); ++i) {
    picture.body +=
        svg::cross({places.x(i), y_of(times[i]["mean"].number())}, 4,
                   "stroke=\"#000000\" stroke-width=\"1.4\"") +
        svg::circle({places.x(i), y_of(times[i]["max"].number())}, 3.5, "stroke=\"#000000\" fill=\"none\"");
  }
  return picture;
}

}  // namespace study::report
