#include "libstudy/console/certificate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <filesystem>
#include <set>

namespace study {

namespace {

// ECMA-48 colour sequences.
constexpr const char* red = "\033[31m";
constexpr const char* yellow = "\033[33m";
constexpr const char* plain = "\033[0m";

constexpr const char* profile_head = "   p99 ms  longest  hitches anim err";
constexpr const char* profile_meaning =
    "p99, longest: intervals, ms; hitches: intervals beyond 1.5 medians; anim err: animation error, ms; all "
    "are "
    "means over the trials, but for the longest of all\n";

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

struct NameColumn {
  std::string title;
  std::vector<std::string> names;

  bool differs() const { return std::set<std::string>(names.begin(), names.end()).size() > 1; }
};

/// The columns of all rows: scene, n_*, method and effects. For a protocol with factors: the level of each
/// factor and the requested timing profile.
std::vector<NameColumn> columns_of(const Rows& rows) {
  std::vector<NameColumn> out;
  if (!rows.front().levels.empty()) {
    for (const auto& [factor, level] : rows.front().levels) out.push_back({factor, {}});
    out.push_back({"asked", {}});
  } else {
    for (const char* title : {"scene", "n*", "method", "effects"}) out.push_back({title, {}});
  }
  for (const CertificateRow& row : rows) {
    std::vector<std::string> names{scene_of(row, rows), row.what.n_star, row.what.method, row.what.effects};
    if (!rows.front().levels.empty()) {
      names.clear();
      for (const auto& [factor, level] : row.levels) names.push_back(level);
      names.resize(out.size() - 1);
      names.push_back(row.timing);
    }
    for (std::size_t i = 0; i < out.size(); ++i) out[i].names.push_back(names[i]);
  }
  return out;
}

/// The text that names each row's stimulus: scene, n_*, method and effects. Names in which the rows differ
/// are table columns, with their titles in `head`; names that all rows share are in `shared`, for the heading
/// above the table. For a protocol with factors, all names are table columns.
struct Shown {
  std::string head, shared;
  std::vector<std::string> lines;  ///< text of the columns, one string per row
};

Shown shown_in(const Rows& rows) {
  Shown out;
  out.lines.resize(rows.size());
  for (const NameColumn& column : columns_of(rows)) {
    if (rows.front().levels.empty() && !column.differs()) {
      if (!column.names[0].empty()) out.shared += (out.shared.empty() ? "" : ", ") + column.names[0];
      continue;
    }
    std::size_t width = column.title.size();
    for (const std::string& name : column.names) width = std::max(width, name.size());
    out.head += fmt::format("{:{}}  ", column.title, width);
    for (std::size_t i = 0; i < rows.size(); ++i)
      out.lines[i] += fmt::format("{:{}}  ", column.names[i], width);
  }
  return out;
}

/// The numbers of one row. A row without a schedule shows "-" for nominal moments, deviations from them and
/// the largest lateness.
std::string format_row(const CertificateRow& row) {
  const bool scheduled = row.nominal.mean > 0;
  const auto nominal = [&](double value, const char* form) {
    return scheduled ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  std::string profile;  // values in the columns of profile_head
  if (!row.levels.empty()) {
    const auto& error_ms = row.animation_error_ms;
    profile = fmt::format(" {:8.3f} {:8.3f} {:8.2f} {:>8}", row.p99_ms, row.longest_ms, row.hitches,
                          error_ms ? fmt::format("{:.3f}", *error_ms) : "-");
  }
  return fmt::format("{:>6} {:>6} {:7} {:8.3f} {:>7} {:8.3f} {:>7}{} {:7} {:>8} {:5} {:9} {:5} {:<5}",
                     nominal(row.nominal.mean, "{:g}"), nominal(row.nominal.sd, "{:g}"), row.trials, row.mean,
                     nominal(row.mean_worst, "{:.3f}"), row.sd, nominal(row.sd_worst, "{:.3f}"), profile,
                     row.late, nominal(row.worst_late_ms, "{:.3f}"), row.pass, row.degraded, row.fail,
                     row.grades);
}

std::string marked(const std::string& line, const char* word, const char* colour, bool coloured) {
  return (coloured ? colour : "") + line + " " + word + (coloured ? plain : "");
}

}  // namespace

std::string certificate_table(const Rows& rows, FpsMean mean, bool coloured) {
  if (rows.empty()) return "";
  const Shown shown = shown_in(rows);
  const bool profiles = !rows.front().levels.empty();
  std::string text = "Timing certificate" + (shown.shared.empty() ? "" : " of " + shown.shared) + " (" +
                     (mean == FpsMean::Harmonic ? "harmonic" : "arithmetic") +
                     " mean, frames/s; worst = largest distance of one trial)\n" +
                     (profiles ? profile_meaning : "") + shown.head +
                     "    mu  delta  trials  mu real   worst   d real   worst" +
                     (profiles ? profile_head : "") + "    late worst ms  pass  degraded  fail grade\n";
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
  }
  return text;
}

std::string format_certificate(const Rows& rows, FpsMean mean, bool coloured) {
  const std::string text = certificate_table(rows, mean, coloured);
  if (rows.empty()) return text;
  std::int64_t pass = 0, fail = 0, all = 0;
  for (const CertificateRow& row : rows) {
    pass += row.pass;
    fail += row.fail;
    all += row.trials;
  }
  const std::string sum = std::to_string(pass) + " of " + std::to_string(all) + " trials pass";
  if (fail == 0) return text + sum + "\n";
  return text + marked(sum + ",", (std::to_string(fail) + " FAIL").c_str(), red, coloured) + "\n";
}

}  // namespace study
