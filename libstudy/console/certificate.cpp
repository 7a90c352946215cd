#include "libstudy/console/certificate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

namespace study {

namespace {

// ECMA-48 colour sequences.
constexpr const char* red = "\033[31m";
constexpr const char* yellow = "\033[33m";
constexpr const char* plain = "\033[0m";

using Rows = std::vector<CertificateRow>;

/// The scene's file name without folder and extension; the full path if another scene of the rows has the
/// same file name.
std::string scene_of(const CertificateRow& row, const Rows& rows) {
  const auto stem = [](const std::string& scene) { return std::filesystem::path(scene).stem().string(); };
  const bool shared = std::any_of(rows.begin(), rows.end(), [&](const auto& other) {
    return other.what.scene != row.what.scene && stem(other.what.scene) == stem(row.what.scene);
  });
  return shared ? row.what.scene : stem(row.what.scene);
}

/// Names of the stimuli: as table columns where the rows differ, as words of the heading where all rows
/// agree.
struct Shown {
  std::string head, shared;
  std::vector<std::string> lines;  ///< text of the columns, one string per row
};

Shown shown_in(const Rows& rows) {
  Shown out;
  out.lines.resize(rows.size());
  constexpr std::array titles{"scene", "n*", "method", "effects"};
  for (std::size_t column = 0; column < titles.size(); ++column) {
    std::vector<std::string> cells;
    std::size_t width = std::string(titles[column]).size();
    for (const auto& row : rows) {
      const std::array names{scene_of(row, rows), row.what.n_star, row.what.method, row.what.effects};
      cells.push_back(names[column]);
      width = std::max(width, cells.back().size());
    }
    if (const std::set<std::string> different(cells.begin(), cells.end()); different.size() < 2) {
      if (!cells.empty() && !cells[0].empty()) out.shared += (out.shared.empty() ? "" : ", ") + cells[0];
      continue;
    }
    out.head += fmt::format("{:{}}  ", titles[column], width);
    for (std::size_t i = 0; i < rows.size(); ++i) out.lines[i] += fmt::format("{:{}}  ", cells[i], width);
  }
  return out;
}

/// The numbers of one row. A row without a schedule shows "-" for nominal moments, deviations and lateness.
std::string format_row(const CertificateRow& row) {
  const bool scheduled = row.nominal.mean > 0;
  const auto nominal = [&](double value, const char* form) {
    return scheduled ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  return fmt::format("{:>6} {:>6} {:7} {:8.3f} {:>7} {:8.3f} {:>7} {:7} {:>8} {:5} {:9} {:5} {:<5}",
                     nominal(row.nominal.mean, "{:g}"), nominal(row.nominal.sd, "{:g}"), row.trials, row.mean,
                     nominal(row.mean_worst, "{:.3f}"), row.sd, nominal(row.sd_worst, "{:.3f}"), row.late,
                     nominal(row.worst_late_ms, "{:.3f}"), row.pass, row.degraded, row.fail, row.grades);
}

std::string marked(const std::string& line, const char* word, const char* colour, bool coloured) {
  return (coloured ? colour : "") + line + " " + word + (coloured ? plain : "");
}

}  // namespace

std::string format_certificate(const Rows& rows, FpsMean mean, bool coloured) {
  const Shown shown = shown_in(rows);
  std::string text = "Timing certificate" + (shown.shared.empty() ? "" : " of " + shown.shared) + " (" +
                     (mean == FpsMean::Harmonic ? "harmonic" : "arithmetic") +
                     " mean, frames/s; worst = largest distance of one trial)\n" + shown.head +
                     "    mu  delta  trials  mu real   worst   d real   worst    late worst ms  pass  "
                     "degraded  fail grade\n";
  std::int64_t pass = 0, fail = 0, all = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const std::string line = shown.lines[i] + format_row(row);
    if (row.fail > 0)
      text += marked(line, "FAIL", red, coloured);
    else if (row.degraded > 0)
      text += marked(line, "DEGRADED", yellow, coloured);
    else
      text += line;
    text += '\n';
    pass += row.pass;
    fail += row.fail;
    all += row.trials;
  }
  const std::string sum = std::to_string(pass) + " of " + std::to_string(all) + " trials pass";
  if (fail == 0) return text + sum + "\n";
  return text + marked(sum + ",", (std::to_string(fail) + " FAIL").c_str(), red, coloured) + "\n";
}

}  // namespace study
