#include "libstudy/sweep/run/accuracy_page.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "libstudy/sweep/run/work_precision.hpp"
#include "stats/figures/html.hpp"

namespace study {

namespace {

using html::figure;
using html::list;
using html::paragraph;
using html::section;
using html::subsection;
using svg::escaped;

std::string to_html(const std::string& caption, const figures::TextTable& table) {
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
               "Compared pictures: " + (plan.kept.empty()
                                            ? std::string("none.")
                                            : escaped(plan.kept) + " px, drawn apart from what is timed."),
               "Machine: " + escaped(prices.origin.machine) + ".",
               "Program: <span class=\"hash\">" + escaped(prices.origin.program) + "</span>."});
}

std::string floor_of(const PriceList& prices, SweepError error) {
  const double floor = prices.floor[static_cast<std::size_t>(error)];
  if (error == SweepError::Density) return "It needs no reference.";
  return fmt::format(
      "The floor is {:.3g} %: by so much the reference differs from itself when its start moves by an ulp. "
      "The reference {}.",
      floor, convergence(prices, error));
}

/// The errors of the water, and those of the pictures if the sweep stored pictures.
std::vector<SweepError> errors_in(const PriceList& prices) {
  std::vector<SweepError> out;
  for (std::size_t e = 0; e < sweep_error_count; ++e)
    if (e < water_error_count || prices.pictures()) out.push_back(static_cast<SweepError>(e));
  return out;
}

std::string parting(const PriceList& prices) {
  if (!prices.pictures()) return paragraph("The sweep kept no pictures: --pictures.");
  const bool part = std::isfinite(prices.parting_s);
  return paragraph(
      parting_in_words(prices) + " Errors of pictures are taken ten times a second" +
      (part ? ", until then, and averaged. After it only the errors of the water are given, and the film's "
              "structure and flicker, which are of the whole run."
            : " and averaged; the film's structure and flicker are of the whole run in any case."));
}

std::string orders(const PriceList& prices) {
  if (prices.orders.empty()) return "";
  std::vector<std::string> lines;
  for (const auto& order : prices.orders) lines.push_back(escaped(in_words(order)) + ".");
  return paragraph(
             "The order says how the distance of a run from the next finer one falls with the step: 1 halves "
             "it "
             "with the step, 0 or less does not converge.") +
         list(lines);
}

std::string diagrams(const PriceList& prices) {
  std::string out = paragraph(
      "Down and to the left is better. A mark is a setting: its mean error, with a stroke from the least "
      "seed "
      "to the largest. A line joins the settings of a method that no other of that method beats in time and "
      "error at once; a ring marks those that none of any method beats. Dashed lines upright are the time of "
      "a frame at 120, 90 and 60 Hz.");
  for (const auto error : errors_in(prices)) {
    const auto picture = work_precision(prices, error);
    out += subsection(std::string("Error of ") + sweep_error_words[static_cast<std::size_t>(error)],
                      picture ? figure(*picture, floor_of(prices, error))
                      : std::isnan(prices.floor[static_cast<std::size_t>(error)])
                          ? paragraph("Not known: " + why_no_price(prices) + ".")
                          : paragraph("No setting has an error above 0."));
  }
  return out + subsection("Pictures", parting(prices)) + subsection("Orders", orders(prices));
}

std::string fronts(const PriceList& prices) {
  html::Table table("Settings that none beats, for each error, the fastest first",
                    {"method", "setting", "ms mean", "p95", "error, % [least, largest seed]"});
  for (const auto error : errors_in(prices)) {
    const auto e = static_cast<std::size_t>(error);
    table.group(std::string("Error of ") + sweep_error_words[e]);
    for (const std::size_t i : pareto_front(prices.settings, error)) {
      const auto& one = prices.settings[i];
      table.row({sim::method_name(one.setting.method), escaped(in_words(one.setting)),
                 figures::number(one.ms_mean, 2), figures::number(one.ms_p95, 2), in_words(one.errors[e])});
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
         to_html("Price list: the water", prices_to_read(prices, ErrorPart::Water)) +
         (prices.pictures() ? to_html("Price list: pictures", prices_to_read(prices, ErrorPart::Pictures))
                            : "");
}

std::string setting_section(const PriceList& prices) {
  return paragraph(
             "tau is that of Eq. 11 with the paper's a and b, frames/s, on a display with the setting's "
             "rate: "
             "below 0 people see that frames come too slowly.") +
         to_html("Settings: the water", settings_to_read(prices, ErrorPart::Water)) +
         (prices.pictures() ? to_html("Settings: pictures", settings_to_read(prices, ErrorPart::Pictures))
                            : "");
}

}  // namespace

std::string accuracy_page(const PriceList& prices, const SweepPlan& plan) {
  const std::string title = "What accuracy costs in time: " + plan.scene;
  return html::whole_page(title,
                          "<main id=\"main\">\n<h1>" + escaped(title) + "</h1>\n" + in_short(plan, prices) +
                              section("diagrams", "Work and precision", diagrams(prices)) +
                              section("front", "The best for the time", fronts(prices)) +
                              section("prices", "What a turn of a knob costs", price_section(prices)) +
                              section("settings", "All settings", setting_section(prices)) + "</main>\n");
}

}  // namespace study
