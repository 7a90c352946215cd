#pragma once
/// The timing certificate as text for the experimenter.

#include <string>
#include <vector>

#include "libstudy/store/read/status.hpp"

namespace study {

/// One line per row: nominal and realised mean mu and standard deviation delta of the frame rate (frames/s),
/// the number of trials, the largest deviation of a trial from each nominal value, late frames and the
/// largest lateness (ms), counts of verdicts, grades. The last line counts the trials that pass and those
/// that fail. "-" as nominal: frames were shown as fast as the method ran. Scene, n_*, method and effects are
/// columns if the rows differ in them, else words of the heading. A row with a failed trial ends in FAIL,
/// another row with a degraded trial in DEGRADED. `coloured` (for a terminal): a FAIL row is red, a DEGRADED
/// row yellow. `mean`: harmonic or arithmetic, the kind of mean in the rows. Empty without rows.
///
/// Rows of a protocol with factors have other columns: their levels and the requested timing profile instead
/// of scene, n_*, method and effects. At the end come the realised 99th percentile of the frame intervals,
/// longest interval, hitches (intervals longer than 1.5 times the median) and animation error (mean absolute
/// difference between a frame's step of simulated time and its interval).
std::string format_certificate(const std::vector<CertificateRow>& rows, FpsMean mean, bool coloured);

/// The same without the last line, for rows that are not trials.
std::string certificate_table(const std::vector<CertificateRow>& rows, FpsMean mean, bool coloured);

}  // namespace study
