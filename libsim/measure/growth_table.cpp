#include "libsim/measure/growth_table.hpp"

#include <cmath>

#include "stats/base/error.hpp"
#include "stats/figures/log_chart.hpp"
#include "stats/inference/linear_fit.hpp"

namespace measure {

Growth growth_of(const std::vector<GrowthRow>& rows) {
  std::vector<double> log_particles, log_ms;
  for (const auto& row : rows) {
    log_particles.push_back(std::log(row.particles));
    log_ms.push_back(std::log(row.ms_substep_mean));
  }
  const auto fit = stats::fit_linear({log_particles}, log_ms);
  if (!fit) {
    throw base::Error("--n-star", "no exponent of growth follows from these sizes: " + fit.reason(),
                      "give two or more different sizes, such as 4k,8k,16k");
  }
  Growth out{.exponent = fit->coefficients[1], .factor = std::exp(fit->coefficients[0])};
  if (!fit->standard_errors.empty()) out.standard_error = fit->standard_errors[1];
  return out;
}

std::string in_words(const Growth& growth, std::size_t sizes) {
  return "exponent " + figures::number(growth.exponent, 3) + ", standard error " +
         figures::number(growth.standard_error, 3) + ", over " + std::to_string(sizes) + " sizes";
}

figures::TextTable to_table(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth) {
  figures::TextTable out{
      {"scene", "method", "backend", "n_star", "frames", "particles_mean", "substeps_mean", "ms_substep_mean",
       "ms_substep_p99", "ms_frame_mean", "density_error_mean", "column_bytes_per_particle",
       "device_bytes_per_particle", "exponent", "exponent_se"},
      {}};
  for (const auto& row : rows) {
    out.rows.push_back({run.scene, run.method, run.backend, row.n_star, std::to_string(run.frames),
                        figures::number(row.particles, 0), figures::number(row.substeps_mean, 2),
                        figures::number(row.ms_substep_mean, 4), figures::number(row.ms_substep_p99, 4),
                        figures::number(row.ms_frame_mean, 4), figures::number(row.density_error_mean, 6),
                        figures::number(row.column_bytes, 1), figures::number(row.device_bytes, 1),
                        figures::number(growth.exponent, 4), figures::number(growth.standard_error, 4)});
  }
  return out;
}

std::string to_svg(const GrowthRun& run, const std::vector<GrowthRow>& rows, const Growth& growth) {
  figures::LogChart chart{.title = run.scene + ", " + run.method + " on " + run.backend,
                          .x_title = "particles",
                          .y_title = "ms a substep: mean, and up to the 99th percentile of frames",
                          .note = in_words(growth, rows.size()),
                          .slope = growth.exponent,
                          .factor = growth.factor};
  for (const auto& row : rows)
    chart.points.push_back({row.particles, row.ms_substep_mean, row.ms_substep_p99});
  return to_svg(chart);
}

}  // namespace measure
