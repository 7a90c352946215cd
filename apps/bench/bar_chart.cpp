#include "apps/bench/bar_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace apps {

namespace {

constexpr int label_px = 110;
constexpr int plot_px = 420;
constexpr int bar_px = 16;
constexpr int group_px = 26;
constexpr int value_px = 80;
// Okabe and Ito's colours: distinct with any colour vision.
constexpr const char* colours[] = {"#56b4e9", "#999999", "#009e73", "#e69f00", "#0072b2"};

template <class... Values>
std::string text(const char* format, Values... values) {
  char out[400];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

std::string escaped(const std::string& raw) {
  std::string out;
  for (const char c : raw) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

/// An interval across the bar whose top is at y: a line with an end stroke on either side.
std::string whisker(double low, double high, int y) {
  const int top = y + 3;
  const int bottom = y + bar_px - 6;
  const int middle = (top + bottom) / 2;
  return text("<path d=\"M%.1f %dH%.1fM%.1f %dV%dM%.1f %dV%d\" stroke=\"black\" fill=\"none\"/>\n", low,
              middle, high, low, top, bottom, high, top, bottom);
}

}  // namespace

std::string to_svg(const BarChart& chart) {
  double most = 0;
  for (const auto& bar : chart.bars) {
    if (std::isfinite(bar.value)) most = std::max(most, bar.value);
    if (std::isfinite(bar.high)) most = std::max(most, bar.high);
  }
  if (most <= 0) most = 1;
  std::string body;
  int y = 34;
  std::size_t within = 0;
  for (std::size_t i = 0; i < chart.bars.size(); ++i) {
    const auto& bar = chart.bars[i];
    if (i == 0 || bar.group != chart.bars[i - 1].group) {
      y += group_px;
      within = 0;
      body +=
          text("<text x=\"8\" y=\"%d\" font-weight=\"bold\">%s</text>\n", y - 6, escaped(bar.group).c_str());
    }
    const auto share_of = [&](double value) {
      return std::isfinite(value) ? std::clamp(value / most, 0.0, 1.0) : 0.0;
    };
    const double share = share_of(bar.value);
    body += text("<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%s</text>\n", label_px - 6, y + bar_px - 4,
                 escaped(bar.label).c_str());
    body += text("<rect x=\"%d\" y=\"%d\" width=\"%.1f\" height=\"%d\" fill=\"%s\"/>\n", label_px, y,
                 share * plot_px, bar_px - 3, colours[within++ % std::size(colours)]);
    const bool interval = std::isfinite(bar.low) && std::isfinite(bar.high);
    if (interval)
      body += whisker(label_px + share_of(bar.low) * plot_px, label_px + share_of(bar.high) * plot_px, y);
    const double end = std::max(share, interval ? share_of(bar.high) : 0.0);
    body += text("<text x=\"%.1f\" y=\"%d\">%.*f %s</text>\n", label_px + end * plot_px + 5, y + bar_px - 4,
                 chart.digits, bar.value, escaped(chart.unit).c_str());
    y += bar_px;
  }
  const int width = label_px + plot_px + value_px;
  return text(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
             "font-family=\"sans-serif\" "
             "font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
             width, y + 12) +
         text("<text x=\"8\" y=\"20\" font-size=\"14\">%s</text>\n", escaped(chart.title).c_str()) + body +
         "</svg>\n";
}

}  // namespace apps
