#include "apps/bench/accuracy/accuracy_page.hpp"

#include <fmt/core.h>
#include <algorithm>

#include "apps/bench/accuracy/work_precision.hpp"
#include "apps/common/html.hpp"

namespace apps {

namespace {

using html::figure;
using html::list;
using html::paragraph;
using html::section;
using html::subsection;
using svg::escaped;

std::string to_html(const std::string& caption, const TextTable& table) {
  html::Table out(caption, table.head);
  for (auto row : table.rows) {
    for (auto& cell : row) cell = escaped(cell);
    out.row(row);
  }
  return out.html();
}

std::string in_short(const SweepPlan& plan, const PriceList& prices) {
  int fewest = prices.settings.empty() ? 0 : prices.settings.front().seeds, most = fewest;
  for (const auto& one : prices.settings) {
    fewest = std::min(fewest, one.seeds);
    most = std::max(most, one.seeds);
  }
  return list({fmt::format("Scene: {}, n_* = {}, {:.4g} s of content; seeds a setting: {} to {}.",
                           escaped(plan.scene), plan.n_star, plan.seconds, fewest, most),
               "A frame's time: " + std::string(plan.size.empty()
                                                    ? "the solver alone; nothing was drawn."
                                                    : "solver and picture of " + escaped(plan.size) + "."),
               "Machine: " + escaped(prices.origin.machine) + ".",
               "Program: <span class=\"hash\">" + escaped(prices.origin.program) + "</span>."});
}

std::string floor_of(const PriceList& prices, SweepError error) {
  const double floor = prices.floor[static_cast<std::size_t>(error)];
  if (error == SweepError::Density) return "It needs no reference.";
  return fmt::format(
      "The floor is {:.3g} %: as much does the reference differ from itself when its start moves by an ulp. "
      "The reference {}.",
      floor, convergence(prices, error));
}

std::string diagrams(const PriceList& prices) {
  std::string out = paragraph(
      "Down and to the left is better. A mark is a setting: its mean error, with a stroke from the least "
      "seed "
      "to the largest. A line joins the settings of a method that no other of that method beats in time and "
      "error at once; a ring marks those that none of any method beats. Dashed lines upright are the time of "
      "a frame at 120, 90 and 60 Hz.");
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    const auto error = static_cast<SweepError>(e);
    const auto picture = work_precision(prices, error);
    out += subsection(
        std::string("Error of ") + sweep_error_words[e],
        picture ? figure(*picture, floor_of(prices, error)) : paragraph("No setting has an error above 0."));
  }
  return out;
}

std::string fronts(const PriceList& prices) {
  html::Table table("Settings that none beats, for each error, the fastest first",
                    {"method", "setting", "ms mean", "p95", "error, % [least, largest seed]"});
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    table.group(std::string("Error of ") + sweep_error_words[e]);
    for (const std::size_t i : pareto_front(prices.settings, static_cast<SweepError>(e))) {
      const auto& one = prices.settings[i];
      table.row({sim::method_name(one.setting.method), escaped(in_words(one.setting)), number(one.ms_mean, 2),
                 number(one.ms_p95, 2), in_words(one.errors[e])});
    }
  }
  return table.html();
}

std::string price_section(const PriceList& prices) {
  return paragraph(
             "What one turn of a knob changes, from the method's usual setting: milliseconds of the mean "
             "frame, and each error in per cent. Below 0 is less. Milliseconds stand with the quartiles of "
             "the differences between frames at the same instant; where zero lies between them the knob is "
             "free. Errors stand with the least and largest difference over all pairs of seeds.") +
         to_html("Price list", prices_to_read(prices));
}

}  // namespace

std::string accuracy_page(const PriceList& prices, const SweepPlan& plan) {
  const std::string title = "What accuracy costs in time: " + plan.scene;
  return html::whole_page(
      title, "<main id=\"main\">\n<h1>" + escaped(title) + "</h1>\n" + in_short(plan, prices) +
                 section("diagrams", "Work and precision", diagrams(prices)) +
                 section("front", "The best for the time", fronts(prices)) +
                 section("prices", "What a turn of a knob costs", price_section(prices)) +
                 section("settings", "All settings", to_html("Settings", settings_to_read(prices))) +
                 "</main>\n");
}

}  // namespace apps
