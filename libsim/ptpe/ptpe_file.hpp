#pragma once
/// ptpe.toml: a fitted PTPE model, passed from the study to the solver. It gives the mean frame rate that is
/// just satisfactory, mu(delta) = a exp(b delta), at a standard deviation delta.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "stats/ptpe/ptpe.hpp"

namespace sim {

/// The confidence interval of the threshold mu at one value of delta (standard deviation of the frame rate).
struct PtpeBandPoint {
  double delta = 0;            ///< frames/s
  std::array<double, 2> mu{};  ///< 95 % interval of mu(delta) over participants, frames/s
  /// False if the study showed no frame rates near the curve at this delta: mu is then extrapolated.
  bool in_reach = true;
};

/// Contents of ptpe.toml, which `vip-stats fit-ptpe` writes and every solver program can load.
struct PtpeFile {
  static constexpr int format_version = 2;  ///< format 1, without a band, can be read too

  stats::PtpeModel model;            ///< a in frames/s, b in s/frame, and which mean of the frame rate mu is
  double level = 4;                  ///< satisfaction score on the curve mu(delta), in [1, 7]
  std::array<double, 2> a_ci{0, 0};  ///< 95 % interval over participants
  std::array<double, 2> b_ci{0, 0};
  /// By ascending delta; each interval contains a exp(b delta); empty in format 1.
  std::vector<PtpeBandPoint> band;
  int n_participants = 0;
  int n_simulated = 0;          ///< simulated observers among the participants; the key may be missing
  bool test_data = false;       ///< true if fitted to test data; the key may be missing
  std::string participant;      ///< code of the person whose own curve this is; empty: a fit of all people
  std::string protocol_sha256;  ///< 64 hexadecimal digits
  std::string date_utc;         ///< ISO 8601 with seconds, "2026-01-31T12:00:00Z"
};

/// One line of text: the model, its level, the widest part of its band, and the number of participants. It
/// also states if participants were simulated and if the answers are test data.
std::string describe(const PtpeFile& file);

/// Reads the text of a PTPE file. base::Error at file:line:column for contents that describe no valid fit,
/// such as an unknown key, a wrong type or range, a or b outside its own interval, a exp(b delta) outside its
/// band, or a newer format.
PtpeFile parse_ptpe_file(std::string_view text, const std::string& name);
PtpeFile read_ptpe_file(const std::filesystem::path& path);
/// Text of a PTPE file, from which parse_ptpe_file reads the same values; format 1 without a band.
/// std::invalid_argument for a number that is not finite.
std::string format_ptpe_file(const PtpeFile& file);

}  // namespace sim
