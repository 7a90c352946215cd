#include "apps/study/desk/certificate.hpp"

#include <cstdio>

namespace apps {

namespace {

// ECMA-48.
constexpr const char* red = "\033[31m";
constexpr const char* yellow = "\033[33m";
constexpr const char* plain = "\033[0m";

std::string format_row(const study::CertificateRow& row) {
  char text[240];
  std::snprintf(text, sizeof text, "%6g %6g %7lld %8.3f %7.3f %8.3f %7.3f %7lld %8.3f %5lld %9lld %5lld %-5s",
                row.nominal.mean, row.nominal.sd, static_cast<long long>(row.trials), row.mean,
                row.mean_worst, row.sd, row.sd_worst, static_cast<long long>(row.late), row.worst_late_ms,
                static_cast<long long>(row.pass), static_cast<long long>(row.degraded),
                static_cast<long long>(row.fail), row.grades.c_str());
  return text;
}

std::string marked(const std::string& line, const char* word, const char* colour, bool coloured) {
  return (coloured ? colour : "") + line + " " + word + (coloured ? plain : "");
}

}  // namespace

std::string format_certificate(const std::vector<study::CertificateRow>& rows, study::FpsMean mean,
                               bool coloured) {
  char head[160];
  std::snprintf(head, sizeof head, "%6s %6s %7s %8s %7s %8s %7s %7s %8s %5s %9s %5s %s\n", "mu", "delta",
                "trials", "mu real", "worst", "d real", "worst", "late", "worst ms", "pass", "degraded",
                "fail", "grade");
  std::string text = std::string("Timing certificate (") +
                     (mean == study::FpsMean::Harmonic ? "harmonic" : "arithmetic") +
                     " mean, frames/s; worst = largest distance of one trial)\n" + head;
  std::int64_t pass = 0, fail = 0, all = 0;
  for (const auto& row : rows) {
    const std::string line = format_row(row);
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

}  // namespace apps
