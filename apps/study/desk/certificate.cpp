#include "apps/study/desk/certificate.hpp"

#include <fmt/core.h>

namespace apps {

namespace {

// ECMA-48.
constexpr const char* red = "\033[31m";
constexpr const char* yellow = "\033[33m";
constexpr const char* plain = "\033[0m";

std::string format_row(const study::CertificateRow& row) {
  return fmt::format("{:6g} {:6g} {:7} {:8.3f} {:7.3f} {:8.3f} {:7.3f} {:7} {:8.3f} {:5} {:9} {:5} {:<5}",
                     row.nominal.mean, row.nominal.sd, row.trials, row.mean, row.mean_worst, row.sd,
                     row.sd_worst, row.late, row.worst_late_ms, row.pass, row.degraded, row.fail, row.grades);
}

std::string marked(const std::string& line, const char* word, const char* colour, bool coloured) {
  return (coloured ? colour : "") + line + " " + word + (coloured ? plain : "");
}

}  // namespace

std::string format_certificate(const std::vector<study::CertificateRow>& rows, study::FpsMean mean,
                               bool coloured) {
  std::string text =
      std::string("Timing certificate (") + (mean == study::FpsMean::Harmonic ? "harmonic" : "arithmetic") +
      " mean, frames/s; worst = largest distance of one trial)\n"
      "    mu  delta  trials  mu real   worst   d real   worst    late worst ms  pass  degraded  "
      "fail grade\n";
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
