#include "libsim/measure/scores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "stats/figures/bar_chart.hpp"
#include "stats/mean_interval.hpp"

namespace measure {

namespace {

using Method = sim::MethodKind;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::vector<double> values_of(const Series& series) {
  std::vector<double> out;
  for (const auto& cell : series.cells) out.push_back(cell.value);
  return out;
}

struct Summary {
  stats::MeanInterval interval;  ///< over the means of the groups of repeats
  std::size_t finite = 0, equal = 0, skipped = 0;
  double pixels = 0;  ///< mean mask size of the cells that were not skipped, px
};

Summary summary_of(const Series& series) {
  Summary out;
  for (const auto& cell : series.cells) {
    out.finite += std::isfinite(cell.value);
    out.equal += std::isinf(cell.value);
    out.skipped += std::isnan(cell.value);
    if (!std::isnan(cell.value)) out.pixels += static_cast<double>(cell.pixels);
  }
  if (out.finite + out.equal) out.pixels /= static_cast<double>(out.finite + out.equal);
  out.interval = stats::mean_interval(stats::group_means(values_of(series), series.repeats));
  // If all pictures are equal, the mean is infinite.
  if (out.finite == 0 && out.equal > 0) out.interval.mean = std::numeric_limits<double>::infinity();
  return out;
}

std::string with_half_width(const Summary& s, int digits) {
  const std::string mean = figures::number(s.interval.mean, digits);
  if (std::isnan(s.interval.low)) return mean;
  return mean + " ± " + figures::number((s.interval.high - s.interval.low) / 2, digits);
}

struct Pair {
  Method better, worse;
};
constexpr Pair pairs[] = {{Method::Ours, Method::FovFluid},
                          {Method::FovFluid, Method::LoRes},
                          {Method::OursTsp, Method::Ours},
                          {Method::Ours, Method::LoRes}};

/// How far the mean of `better` may lie below that of `worse` in the metric; NaN if the paper claims no
/// order.
double allowed_loss(const Pair& pair, Metric metric) {
  if (pair.better == Method::OursTsp) return unknown;
  switch (metric) {
    case Metric::PsnrSalient:
    case Metric::PsnrOverall:
      return 0.1;
    case Metric::SsimStatic:
      return 0.005;
    case Metric::PsnrFov:
      return pair.worse == Method::FovFluid ? 0.75 : unknown;
    default:
      return unknown;
  }
}

std::string verdict(double difference, double loss) {
  if (std::isnan(loss)) return "-";
  if (std::isnan(difference)) return "no data";
  return difference >= -loss ? "holds" : "broken";
}

const MethodScores* find(const ScoreBlock& block, Method method) {
  const auto found = std::find_if(block.methods.begin(), block.methods.end(),
                                  [&](const auto& scores) { return scores.method == method; });
  return found == block.methods.end() ? nullptr : &*found;
}

}  // namespace

const std::array<MetricTraits, metric_count>& all_metrics() {
  static constexpr std::array<MetricTraits, metric_count> metrics{
      {{Metric::PsnrFov, "psnr_fov", "PSNR@fov, dB", 2},
       {Metric::PsnrSalient, "psnr_salient", "PSNR@salient, dB", 2},
       {Metric::PsnrOverall, "psnr_overall", "PSNR@overall, dB", 2},
       {Metric::PsnrFluid, "psnr_fluid", "PSNR@fluid, dB", 2},
       {Metric::SsimStatic, "ssim_static", "SSIM-static", 4},
       {Metric::SsimCumul, "ssim_cumul", "SSIM-cumul", 4},
       {Metric::Flicker, "flicker", "flicker, 8-bit steps squared", 2},
       {Metric::FlickerPeriphery, "flicker_periphery", "flicker beyond 20°", 2}}};
  return metrics;
}

figures::TextTable score_rows(const std::vector<ScoreBlock>& blocks) {
  figures::TextTable out{{"scene", "n_star", "method", "preset", "metric", "mean", "ci_low", "ci_high",
                          "groups", "cells", "equal", "skipped", "pixels"},
                         {}};
  for (const auto& block : blocks) {
    for (const auto& scores : block.methods) {
      for (const auto& metric : all_metrics()) {
        if (scores.of(metric.metric).cells.empty()) continue;
        const Summary s = summary_of(scores.of(metric.metric));
        const int digits = metric.digits + 1;
        out.rows.push_back(
            {block.scene, block.n_star, sim::method_name(scores.method), sim::preset_name(block.preset),
             metric.name, figures::number(s.interval.mean, digits), figures::number(s.interval.low, digits),
             figures::number(s.interval.high, digits), std::to_string(s.interval.n), std::to_string(s.finite),
             std::to_string(s.equal), std::to_string(s.skipped), figures::number(s.pixels, 0)});
      }
    }
  }
  return out;
}

figures::TextTable score_table(const std::vector<ScoreBlock>& blocks) {
  figures::TextTable out{{"scene", "n_star", "preset", "method"}, {}};
  for (const auto& metric : all_metrics()) out.head.emplace_back(metric.title);
  for (const auto& block : blocks) {
    for (const auto& scores : block.methods) {
      const bool floor = scores.method == Method::HiRes;
      std::vector<std::string> row{block.scene, block.n_star, sim::preset_name(block.preset),
                                   sim::method_name(scores.method) + (floor ? " (floor)" : "")};
      for (const auto& metric : all_metrics())
        row.push_back(with_half_width(summary_of(scores.of(metric.metric)), metric.digits));
      out.rows.push_back(row);
    }
  }
  return out;
}

figures::TextTable paired_rows(const std::vector<ScoreBlock>& blocks) {
  figures::TextTable out{
      {"scene", "n_star", "preset", "metric", "difference", "mean", "ci_low", "ci_high", "groups", "verdict"},
      {}};
  for (const auto& block : blocks) {
    for (const auto& metric : all_metrics()) {
      for (const auto& pair : pairs) {
        const auto* better = find(block, pair.better);
        const auto* worse = find(block, pair.worse);
        if (!better || !worse || better->of(metric.metric).cells.empty()) continue;
        const auto differences =
            stats::paired_group_means(values_of(better->of(metric.metric)),
                                      values_of(worse->of(metric.metric)), better->of(metric.metric).repeats);
        const auto s = stats::mean_interval(differences);
        const int digits = metric.digits + 1;
        out.rows.push_back({block.scene, block.n_star, sim::preset_name(block.preset), metric.name,
                            sim::method_name(pair.better) + " - " + sim::method_name(pair.worse),
                            figures::number(s.mean, digits), figures::number(s.low, digits),
                            figures::number(s.high, digits), std::to_string(s.n),
                            verdict(s.mean, allowed_loss(pair, metric.metric))});
      }
    }
  }
  return out;
}

std::string score_chart(const std::vector<ScoreBlock>& blocks, const MetricTraits& metric) {
  figures::BarChart chart;
  chart.title = std::string("Table 1: ") + metric.title + ", mean and 95 % interval";
  chart.digits = metric.digits;
  for (const auto& block : blocks) {
    for (const auto& scores : block.methods) {
      if (scores.of(metric.metric).cells.empty()) continue;
      const auto s = summary_of(scores.of(metric.metric)).interval;
      chart.bars.push_back({block.scene + " " + block.n_star + " " + sim::preset_name(block.preset),
                            sim::method_name(scores.method), s.mean, s.low, s.high});
    }
  }
  return chart.bars.empty() ? "" : figures::to_svg(chart);
}

}  // namespace measure
