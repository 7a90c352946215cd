#pragma once
/// ptpe.toml: a fitted PTPE model, passed from the study to the solver.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "stats/ptpe/ptpe.hpp"

namespace sim {

/// The confidence interval of the threshold at one standard deviation.
struct PtpeBandPoint {
  double delta = 0;            ///< frames/s
  std::array<double, 2> mu{};  ///< 95 % interval of mu(delta) over participants, frames/s
  bool in_reach = true;  ///< false: no frame rates near the curve were shown at this delta; extrapolated
};

/// Written by `vip-stats fit-ptpe` and loaded by every solver program.
struct PtpeFile {
  static constexpr int format_version = 2;  ///< format 1, without a band, can be read too

  stats::PtpeModel model;            ///< a in frames/s, b in s/frame, and the kind of mean used as predictor
  double level = 4;                  ///< satisfaction score of the contour, in [1, 7]
  std::array<double, 2> a_ci{0, 0};  ///< 95 % interval over participants
  std::array<double, 2> b_ci{0, 0};
  std::vector<PtpeBandPoint> band;  ///< deltas ascending, a exp(b delta) inside; empty in format 1
  int n_participants = 0;
  int n_simulated = 0;          ///< simulated observers among them; the key may be missing
  bool test_data = false;       ///< fitted to test data; the key may be missing
  std::string protocol_sha256;  ///< 64 hexadecimal digits
  std::string date_utc;         ///< ISO 8601 with seconds, "2026-01-31T12:00:00Z"
};

/// One line: the model, its level, the widest part of its band, and the number of participants. Says if
/// participants were simulated and if the answers are test data.
std::string describe(const PtpeFile& file);

/// Errors (base::Error at file:line:column): unknown key, wrong type or range, a or b outside its own
/// interval, a exp(b delta) outside its band, newer format.
PtpeFile parse_ptpe_file(std::string_view text, const std::string& name);
PtpeFile read_ptpe_file(const std::filesystem::path& path);
/// Text of a file that parse_ptpe_file reads back to the same values: format 1 without a band.
/// std::invalid_argument for a number that is not finite.
std::string format_ptpe_file(const PtpeFile& file);

}  // namespace sim
