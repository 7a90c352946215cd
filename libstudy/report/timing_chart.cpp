#include <algorithm>
#include <array>
#include <map>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::text;

constexpr double left = 190, width = 430, row = 24, bar = 16, top = 74;

struct Verdict {
  const char* key;
  const char* words;
  const char* fill;
};
constexpr std::array<Verdict, 4> verdicts{{{"pass", "pass", "#0072b2"},
                                           {"degraded", "degraded", "degraded-hatch"},
                                           {"fail", "fail", "fail-hatch"},
                                           {"unjudged", "not judged", "#ffffff"}}};

std::string pattern(const std::string& id, const std::string& ground, const std::string& strokes,
                    const std::string& style) {
  return "<pattern" + svg::attribute("id", id) +
         " width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\">" +
         svg::rectangle({0, 0}, {6, 6}, svg::attribute("fill", ground)) + svg::path(strokes, style) +
         "</pattern>\n";
}

std::string patterns(const std::string& id) {
  return pattern(id + "-degraded-hatch", svg::colour::orange, "M-1,7 L7,-1",
                 "stroke=\"#000000\" stroke-width=\"0.8\"") +
         pattern(id + "-fail-hatch", "#ffffff", "M0,0 L6,6 M6,0 L0,6",
                 "stroke=\"#a03d00\" stroke-width=\"1.6\"");
}

/// SVG attributes of a verdict's bar: a colour, or a pattern that is defined in the picture `id`.
std::string fill_of(const Verdict& verdict, const std::string& id) {
  const std::string fill = verdict.fill;
  return svg::attribute("fill", fill.front() == '#' ? fill : "url(#" + id + "-" + fill + ")") +
         " stroke=\"#000000\"";
}

/// Name of a cell's bar: "50, SD 20" (frames/s) for a setting of a pilot, "Ours, 32k" for a method at one
/// n_*.
std::string name_of(const Field& cell) {
  if (cell["task"].words() != "pilot") return cell["method"].words() + ", " + cell["n_star"].words();
  return svg::number(cell["nominal_mean_fps"].number(), 0) + ", SD " +
         svg::number(cell["nominal_sd_fps"].number(), 0);
}

/// Counts of showings by verdict, for one bar.
struct Line {
  std::array<double, 4> n{};
  double all() const { return n[0] + n[1] + n[2] + n[3]; }
};

std::string legend(const std::string& id) {
  std::string out;
  double x = left;
  for (const auto& verdict : verdicts) {
    out += svg::rectangle({x, 40}, {x + 20, 54}, fill_of(verdict, id)) +
           text({x + 26, 52}, verdict.words, "font-size=\"13\"");
    x += 108;
  }
  return out;
}

std::string drawn(const std::string& id, const std::string& name, const Line& line, double y) {
  std::string out = text({left - 8, y + 13}, name, "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
  double before = 0;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (line.n[i] <= 0) continue;
    const double from = left + width * before / line.all();
    before += line.n[i];
    out += svg::rectangle({from, y}, {left + width * before / line.all(), y + bar}, fill_of(verdicts[i], id));
  }
  return out;
}

}  // namespace

svg::Picture timing_chart(const Field& timing, const std::string& task) {
  std::vector<std::string> order;
  std::map<std::string, Line> lines;
  for (const Field& cell : timing.entries()) {
    if (cell["task"].words() != task) continue;
    const std::string name = name_of(cell);
    const auto [at, fresh] = lines.try_emplace(name);
    if (fresh) order.push_back(name);
    for (std::size_t i = 0; i < verdicts.size(); ++i) at->second.n[i] += cell[verdicts[i].key].number();
  }
  // A bar is left out if no showing was degraded or failed.
  std::erase_if(order, [&](const std::string& name) { return lines[name].n[1] + lines[name].n[2] <= 0; });
  const double more = std::max(0.0, room_for(order) + 8 - left);
  svg::Picture picture{.width = more + left + width + 20, .id = "timing-" + task};
  picture.title = "Verdicts on the timing of the showings";
  picture.description =
      std::string("A bar for each ") +
      (task == "pilot" ? "setting, mean and SD in frames/s" : "method and n*, over scenes") +
      ", in which a showing was degraded or failed: the shares of its showings whose timing passed, was "
      "degraded, failed or could not be judged. The table below holds the counts of each cell.";
  picture.definitions = patterns(picture.id);
  double y = top;
  for (const auto& name : order) {
    picture.body += drawn(picture.id, name, lines[name], y);
    y += row;
  }
  for (int i = 0; i <= 4; ++i) {
    const double x = left + width * i / 4.0;
    picture.body += svg::line({x, y}, {x, y + 6}, "stroke=\"#000000\"") +
                    text({x, y + 22}, svg::number(25 * i, 0) + " %",
                         "class=\"axis\" text-anchor=\"middle\" font-size=\"12\"");
  }
  picture.body = text({8, 20}, picture.title, "font-size=\"15\" font-weight=\"bold\"") +
                 moved_right(picture.body + legend(picture.id), more);
  picture.height = y + 34;
  return picture;
}

}  // namespace study::report
