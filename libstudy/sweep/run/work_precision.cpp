#include "libstudy/sweep/run/work_precision.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>

#include "stats/figures/log_chart.hpp"

namespace study {

namespace {

constexpr double left_px = 58, top_px = 34, plot_width_px = 476, plot_height_px = 320;
constexpr double right_px = left_px + plot_width_px, bottom_px = top_px + plot_height_px;
constexpr const char* axis = R"( stroke="#333" fill="none")";
constexpr const char* grid = R"( stroke="#ddd" fill="none")";
constexpr const char* dashed = R"( stroke="#555" fill="none" stroke-dasharray="5 4")";
constexpr const char* middle = R"( text-anchor="middle")";

/// Frame rates, in frames/s, whose frame periods are marked by dashed lines.
constexpr std::array<double, 3> frame_rates{120, 90, 60};

struct Look {
  sim::MethodKind method;
  const char* colour;
};
constexpr std::array<Look, 5> looks{{{sim::MethodKind::LoRes, svg::colour::orange},
                                     {sim::MethodKind::HiRes, svg::colour::blue},
                                     {sim::MethodKind::FovFluid, svg::colour::purple},
                                     {sim::MethodKind::Ours, svg::colour::green},
                                     {sim::MethodKind::OursTsp, svg::colour::vermilion}}};
static_assert(looks.size() == std::tuple_size_v<std::remove_cvref_t<decltype(sim::all_methods())>>,
              "a method without a row is not drawn");

std::string polygon(svg::Point at, const std::vector<svg::Point>& corners, const std::string& attributes) {
  std::string moves;
  for (const auto& corner : corners)
    moves += svg::move(moves.empty() ? 'M' : 'L', {at.x + corner.x, at.y + corner.y});
  return svg::path(moves + "Z", attributes);
}

/// A mark whose shape depends on the method, so that methods can be distinguished without colour.
std::string mark(sim::MethodKind method, const char* colour, svg::Point at) {
  const std::string fill = svg::attribute("fill", colour) + svg::attribute("stroke", "#fff");
  switch (method) {
    case sim::MethodKind::LoRes:
      return svg::circle(at, 4.5, fill);
    case sim::MethodKind::HiRes:
      return svg::rectangle({at.x - 4, at.y - 4}, {at.x + 4, at.y + 4}, fill);
    case sim::MethodKind::FovFluid:
      return polygon(at, {{-5, 4}, {5, 4}, {0, -5}}, fill);
    case sim::MethodKind::Ours:
      return polygon(at, {{-5.5, 0}, {0, -5.5}, {5.5, 0}, {0, 5.5}}, fill);
    case sim::MethodKind::OursTsp:
      break;
  }
  return svg::cross(at, 4, svg::attribute("stroke", colour) + " stroke-width=\"2.5\" fill=\"none\"");
}

struct Diagram {
  figures::LogScale x, y;
  std::size_t error;

  svg::Point at(double ms, double value) const {
    return {left_px + x.share(ms) * plot_width_px, bottom_px - y.share(value) * plot_height_px};
  }
  svg::Point at(const SettingResult& one) const { return at(one.ms_mean, one.errors[error].mean); }
  /// Clamps an error to the y axis: the error of a seed may be 0, which a logarithmic axis cannot show.
  double within(double value) const { return std::clamp(value, y.low, y.high); }
};

/// Settings that logarithmic axes can show: time and error above 0.
std::vector<SettingResult> drawable(const PriceList& list, std::size_t error) {
  std::vector<SettingResult> out;
  for (const auto& one : list.settings)
    if (one.ms_mean > 0 && one.errors[error].mean > 0) out.push_back(one);
  return out;
}

Diagram diagram_of(const std::vector<SettingResult>& settings, double floor, std::size_t error) {
  double fastest = settings.front().ms_mean, slowest = fastest;
  double least = settings.front().errors[error].mean, most = least;
  for (const auto& one : settings) {
    fastest = std::min(fastest, one.ms_mean);
    slowest = std::max(slowest, one.ms_mean);
    least = std::min(least, one.errors[error].mean);
    most = std::max({most, one.errors[error].mean, one.errors[error].high});
  }
  if (floor > 0) least = std::min(least, floor);
  const auto x = figures::log_ticks(fastest, slowest), y = figures::log_ticks(least, most);
  return {{x.front(), x.back()}, {y.front(), y.back()}, error};
}

std::string axes(const Diagram& diagram) {
  std::string out;
  for (const double tick : figures::log_ticks(diagram.x.low, diagram.x.high)) {
    const double x = diagram.at(tick, diagram.y.low).x;
    out += svg::line({x, top_px}, {x, bottom_px}, grid) +
           svg::text({x, bottom_px + 17}, figures::tick_label(tick), middle);
  }
  for (const double tick : figures::log_ticks(diagram.y.low, diagram.y.high)) {
    const double y = diagram.at(diagram.x.low, tick).y;
    out += svg::line({left_px, y}, {right_px, y}, grid) +
           svg::text({left_px - 6, y + 4}, figures::tick_label(tick), "text-anchor=\"end\"");
  }
  return out + svg::line({left_px, top_px}, {left_px, bottom_px}, axis) +
         svg::line({left_px, bottom_px}, {right_px, bottom_px}, axis) +
         svg::text({(left_px + right_px) / 2, bottom_px + 36}, "ms a frame, mean", middle);
}

std::string limits(const Diagram& diagram, double floor) {
  std::string out;
  for (const double rate : frame_rates) {
    const double ms = 1000 / rate;
    if (ms < diagram.x.low || ms > diagram.x.high) continue;
    const double x = diagram.at(ms, diagram.y.low).x;
    out += svg::line({x, top_px}, {x, bottom_px}, dashed) +
           svg::text({x, top_px - 5}, fmt::format("{:.0f}{}", rate, rate == frame_rates.back() ? " Hz" : ""),
                     middle);
  }
  if (floor > 0) {
    const double y = diagram.at(diagram.x.low, floor).y;
    out += svg::line({left_px, y}, {right_px, y}, dashed) +
           svg::text({right_px - 4, y - 4}, "floor", "text-anchor=\"end\"");
  }
  return out;
}

std::string method_marks(const Diagram& diagram, const std::vector<SettingResult>& settings,
                         const Look& look) {
  std::vector<SettingResult> own;
  for (const auto& one : settings)
    if (one.setting.method == look.method) own.push_back(one);
  std::string strokes, marks, moves;
  for (const auto& one : own) {
    const Spread& error = one.errors[diagram.error];
    strokes += svg::line(diagram.at(one.ms_mean, diagram.within(error.low)),
                         diagram.at(one.ms_mean, diagram.within(error.high)),
                         svg::attribute("stroke", look.colour) + " fill=\"none\"");
    marks += mark(look.method, look.colour, diagram.at(one));
  }
  for (const std::size_t i : pareto_front(own, static_cast<SweepError>(diagram.error)))
    moves += svg::move(moves.empty() ? 'M' : 'L', diagram.at(own[i]));
  if (!moves.empty())
    strokes +=
        svg::path(moves, svg::attribute("stroke", look.colour) + " fill=\"none\" stroke-width=\"1.5\"");
  return strokes + marks;
}

std::string legend() {
  std::string out;
  double x = left_px;
  for (const auto& look : looks) {
    const std::string name = sim::method_name(look.method);
    out +=
        mark(look.method, look.colour, {x + 5, bottom_px + 58}) + svg::text({x + 14, bottom_px + 62}, name);
    x += 34 + 8 * static_cast<double>(name.size());
  }
  return out + svg::circle({x + 6, bottom_px + 58}, 7, "stroke=\"#000\" fill=\"none\"") +
         svg::text({x + 18, bottom_px + 62}, "front");
}

}  // namespace

std::optional<svg::Picture> work_precision(const PriceList& list, SweepError which) {
  const auto error = static_cast<std::size_t>(which);
  const auto settings = drawable(list, error);
  if (settings.empty()) return {};
  const double floor = list.floor[error];
  const Diagram diagram = diagram_of(settings, floor, error);
  const std::string title = fmt::format("Error of {}, per cent, over ms a frame", sweep_error_words[error]);
  const auto front = pareto_front(settings, which);

  svg::Picture out{.width = right_px + 20, .height = bottom_px + 76, .id = sweep_error_columns[error]};
  out.title = title;
  out.description = fmt::format(
      "{} settings, both axes logarithmic. From {:.3g} ms and {:.3g} % to {:.3g} ms and {:.3g} % along the "
      "front.",
      settings.size(), settings[front.front()].ms_mean, settings[front.front()].errors[error].mean,
      settings[front.back()].ms_mean, settings[front.back()].errors[error].mean);
  out.body =
      "<g font-size=\"13\">\n" + axes(diagram) + svg::text({4, 16}, "error, %") + limits(diagram, floor);
  for (const auto& look : looks) out.body += method_marks(diagram, settings, look);
  for (const std::size_t i : front)
    out.body += svg::circle(diagram.at(settings[i]), 8, "stroke=\"#000\" fill=\"none\"");
  out.body += legend() + "</g>\n";
  return out;
}

}  // namespace study
