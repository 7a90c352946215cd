#include <fmt/core.h>
#include <cmath>
#include <numeric>

#include "libstudy/sweep/price_list.hpp"

namespace study {

namespace {

constexpr std::array<const char*, sweep_error_count> short_errors{
    "front %",   "centre %", "kinetic %", "density %", "picture %", "fovea %",
    "salient %", "SSIM %",   "FLIP %",    "film %",    "flicker %"};

std::vector<std::size_t> columns_of_errors(ErrorPart part) {
  const bool water = part == ErrorPart::Water;
  std::vector<std::size_t> out(water ? water_error_count : picture_error_count);
  std::iota(out.begin(), out.end(), water ? 0 : water_error_count);
  return out;
}

}  // namespace

std::string in_words(const Spread& spread) {
  if (std::isnan(spread.mean)) return "-";
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", spread.mean, spread.low, spread.high);
}

std::string in_words(const sim::SolverSetting& setting) {
  std::string out;
  for (const auto& traits : sim::solver_knobs()) {
    const bool own = traits.knob == sim::SolverKnob::Size || setting[traits.knob] != traits.usual;
    if (own && sim::turns(traits.knob, setting.method))
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", traits.words,
                         sim::value_words(traits.knob, setting[traits.knob]));
  }
  return out;
}

std::string convergence(const PriceList& list, SweepError error) {
  if (std::isnan(list.floor[static_cast<std::size_t>(error)])) return "was not measured in it";
  return list.finer.empty()                                ? "was not compared with finer ones"
         : list.converged[static_cast<std::size_t>(error)] ? "counts as converged"
                                                           : "does not count as converged";
}

figures::TextTable setting_table(const PriceList& list) {
  figures::TextTable out{
      .head = {"scene", "machine", "program", "method", "setting", "seeds", "particles", "substeps",
               "ms_mean", "ms_q25", "ms_median", "ms_q75", "ms_p95", "draw_ms_mean", "tau"},
      .rows = {}};
  for (const char* error : sweep_error_columns) {
    for (const char* end : {"", "_low", "_high"}) out.head.push_back(std::string(error) + end);
  }
  for (const auto* part : {&list.finer, &list.settings}) {
    for (const auto& one : *part) {
      auto& row = out.rows.emplace_back();
      row = {list.scene,
             figures::in_a_cell(list.origin.machine),
             list.origin.program,
             sim::method_name(one.setting.method),
             figures::in_a_cell(in_words(one.setting)),
             std::to_string(one.seeds),
             figures::number(one.particles, 0),
             figures::number(one.substeps, 2),
             figures::number(one.ms_mean, 3),
             figures::number(one.ms_low_quartile, 3),
             figures::number(one.ms_median, 3),
             figures::number(one.ms_high_quartile, 3),
             figures::number(one.ms_p95, 3),
             figures::number(one.draw_ms_mean, 3),
             figures::number(one.tau, 2)};
      for (const auto& error : one.errors)
        for (const double value : {error.mean, error.low, error.high})
          row.push_back(figures::number(value, 4));
    }
  }
  return out;
}

figures::TextTable price_table(const PriceList& list) {
  figures::TextTable out{.head = {"scene", "machine", "program", "method", "knob", "from", "to", "ms",
                                  "ms_q25", "ms_q75", "free"},
                         .rows = {}};
  for (const char* error : sweep_error_columns) {
    for (const char* end : {"", "_low", "_high", "_per_ms"}) out.head.push_back(std::string(error) + end);
  }
  for (const auto& price : list.prices) {
    auto& row = out.rows.emplace_back();
    row = {list.scene,
           figures::in_a_cell(list.origin.machine),
           list.origin.program,
           sim::method_name(price.method),
           sim::traits_of(price.knob).column,
           sim::value_words(price.knob, price.from),
           sim::value_words(price.knob, price.to),
           figures::number(price.ms, 3),
           figures::number(price.ms_low_quartile, 3),
           figures::number(price.ms_high_quartile, 3),
           price.free() ? "yes" : "no"};
    for (const auto& error : price.errors) {
      for (const double value : {error.mean, error.low, error.high}) row.push_back(figures::number(value, 4));
      row.push_back(price.free() ? "-" : figures::number(error.mean / price.ms, 4));
    }
  }
  return out;
}

figures::TextTable settings_to_read(const PriceList& list, ErrorPart part) {
  figures::TextTable out{.head = {"method", "setting", "particles", "ms mean", "p95", "tau"}, .rows = {}};
  for (const std::size_t e : columns_of_errors(part)) out.head.emplace_back(short_errors[e]);
  for (const auto& one : list.settings) {
    auto& row = out.rows.emplace_back();
    row = {sim::method_name(one.setting.method), in_words(one.setting),
           figures::number(one.particles, 0),    figures::number(one.ms_mean, 2),
           figures::number(one.ms_p95, 2),       figures::number(one.tau, 1)};
    for (const std::size_t e : columns_of_errors(part)) row.push_back(in_words(one.errors[e]));
  }
  return out;
}

figures::TextTable prices_to_read(const PriceList& list, ErrorPart part) {
  figures::TextTable out{.head = {"method", "knob", "change", "ms [quartiles]"}, .rows = {}};
  for (const std::size_t e : columns_of_errors(part)) out.head.emplace_back(short_errors[e]);
  for (const auto& price : list.prices) {
    auto& row = out.rows.emplace_back();
    row = {sim::method_name(price.method), sim::traits_of(price.knob).words,
           sim::value_words(price.knob, price.from) + " to " + sim::value_words(price.knob, price.to),
           price.free() ? "free"
                        : fmt::format("{:+.2f} [{:+.2f}, {:+.2f}]", price.ms, price.ms_low_quartile,
                                      price.ms_high_quartile)};
    for (const std::size_t e : columns_of_errors(part)) row.push_back(in_words(price.errors[e]));
  }
  return out;
}

std::string in_words(const ObservedOrder& order) {
  std::string steps;
  for (const double step : order.steps) steps += (steps.empty() ? "" : ", ") + figures::number(step, 2);
  return fmt::format("HiRes' order in the {} ({}): front {}, centre {}, kinetic {}", order.of, steps,
                     figures::number(order.order[0], 2), figures::number(order.order[1], 2),
                     figures::number(order.order[2], 2));
}

std::string parting_in_words(const PriceList& list) {
  if (std::isinf(list.parting_s))
    return "The reference's pictures and its second seed's do not diverge within the run.";
  return fmt::format("The reference's pictures and its second seed's diverge {:.2f} s after frame 0.",
                     list.parting_s);
}

std::string why_no_price(const PriceList& list) {
  if (!list.pictures()) return "the sweep kept no pictures";
  return "the reference has no large enough part of its kind before the pictures diverge";
}

std::string to_markdown(const PriceList& list) {
  std::string out = fmt::format("{} on {}\n\n", list.scene, list.origin.machine);
  for (const auto part : {ErrorPart::Water, ErrorPart::Pictures}) {
    if (part == ErrorPart::Pictures && !list.pictures()) continue;
    out += to_markdown(settings_to_read(list, part)) + "\n" + to_markdown(prices_to_read(list, part)) + "\n";
  }
  if (list.pictures()) out += parting_in_words(list) + "\n";
  for (const auto& order : list.orders) out += in_words(order) + "\n";
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    const auto error = static_cast<SweepError>(e);
    if (e >= water_error_count && !list.pictures()) break;
    if (std::isnan(list.floor[e])) {
      out += fmt::format("{}: {}\n", sweep_error_columns[e], why_no_price(list));
    } else {
      out += fmt::format("{}: the floor is {} %; the reference {}\n", sweep_error_columns[e],
                         figures::shortest(list.floor[e]), convergence(list, error));
    }
  }
  return out;
}

}  // namespace study
