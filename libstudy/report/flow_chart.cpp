#include <algorithm>
#include <cmath>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::text;

constexpr double main_x = 16, main_width = 270, side_x = 350, side_width = 300, line_px = 20, pad = 10;

/// A line of a box: a count and its description.
struct Entry {
  const char* words;
  Field n;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
  std::string drawn;
};

Box box(double x, double y, double width, const std::vector<Entry>& entries) {
  Box out{x, y, width, 2 * pad + line_px * static_cast<double>(entries.size()), ""};
  out.drawn = svg::rectangle({x, y}, {x + width, y + out.height},
                             "fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"1.4\"");
  double base = y + pad + 14;
  for (const auto& [words, n] : entries) {
    out.drawn += text({x + 12, base}, words, "font-size=\"14\"");
    out.drawn += text({x + width - 12, base}, n.is_number() ? svg::number(n.number(), 0) : "\xE2\x80\x93",
                      "font-size=\"14\" font-weight=\"bold\" text-anchor=\"end\"" + data_field(n));
    base += line_px;
  }
  return out;
}

/// An arrow. It is drawn by lines, since the id of an SVG marker would have to differ between the charts of a
/// page.
std::string arrow(svg::Point from, svg::Point to) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const double dx = (to.x - from.x) / length, dy = (to.y - from.y) / length;
  const svg::Point base{to.x - 10 * dx, to.y - 10 * dy};
  return svg::line(from, base, "stroke=\"#000000\" stroke-width=\"1.4\"") +
         svg::path(svg::move('M', to) + svg::move('L', {base.x - 4 * dy, base.y + 4 * dx}) +
                       svg::move('L', {base.x + 4 * dy, base.y - 4 * dx}) + "Z",
                   "fill=\"#000000\"");
}

std::vector<Entry> those_with_some(const std::vector<Entry>& all) {
  std::vector<Entry> out;
  for (const auto& entry : all)
    if (entry.n.number() > 0) out.push_back(entry);
  return out;
}

}  // namespace

svg::Picture flow_chart(const Field& flow, const std::string& id, const std::string& task) {
  svg::Picture picture{.width = main_x + main_width + 60, .id = id};
  picture.title = "Flow of participants, " + task;
  picture.description =
      "Boxes from top to bottom: sessions started, sessions completed, participants analysed; beside them "
      "those who left in between, with the reason, and what is counted apart.";
  const std::vector<std::pair<std::vector<Entry>, std::vector<Entry>>> steps{
      {{{"sessions started", flow["started"]}, {"participants in them", flow["participants"]}},
       those_with_some({{"did not consent", flow["no_consent"]},
                        {"not eligible", flow["not_eligible"]},
                        {"stopped early", flow["stopped"]},
                        {"did not come back", flow["dropped_out"]},
                        {"still open", flow["open"]}})},
      {{{"sessions completed", flow["done"]}},
       those_with_some({{"people without an answer to analyse", flow["no_answer"]},
                        {"people left out by rule or hand", flow["excluded_participants"]}})},
      {{{"participants analysed", flow["analysed"]},
        {"trials planned", flow["trials_planned"]},
        {"trials answered", flow["trials_answered"]},
        {"trials left out", flow["trials_excluded"]},
        {"trials analysed", flow["trials_analysed"]}},
       those_with_some({{"sessions planned, not begun", flow["planned"]},
                        {"people withdrew from the study", flow["withdrawn"]},
                        {"sessions of test data, set aside", flow["set_aside"]["test_data"]},
                        {"simulated sessions, set aside", flow["set_aside"]["simulated"]},
                        {"sessions of protocols set aside", flow["set_aside"]["protocols"]},
                        {"practice trials, not analysed", flow["practice"]},
                        {"repeated trials, for retest", flow["repeat"]}})}};
  double y = 40;
  const double middle = main_x + main_width / 2;
  picture.body = text({main_x, 22}, picture.title, "class=\"axis\" font-size=\"15\" font-weight=\"bold\"");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& [here, gone] = steps[i];
    const Box main = box(main_x, y, main_width, here);
    picture.body += main.drawn;
    double next = y + main.height + 34;
    if (!gone.empty()) {
      picture.width = side_x + side_width + 12;
      // The side box is to the right of the arrow to the next step, or for the last step to the right of its
      // box.
      const bool last = i + 1 == steps.size();
      const Box side = box(side_x, last ? y : y + main.height + 12, side_width, gone);
      picture.body += side.drawn;
      const double at = last ? y + pad + 9 : side.y + side.height / 2;
      picture.body += last ? svg::line({main_x + main_width, at}, {side_x, at},
                                       "stroke=\"#000000\" stroke-dasharray=\"3 3\"")
                           : arrow({middle, at}, {side_x, at});
      next = std::max(next, side.y + side.height + 14);
    }
    if (i + 1 < steps.size()) picture.body += arrow({middle, y + main.height}, {middle, next});
    y = next;
  }
  picture.height = y;
  return picture;
}

}  // namespace study::report
