#pragma once
/// The timing certificate as text for the experimenter.

#include <string>
#include <vector>

#include "libstudy/store/read/status.hpp"

namespace study {

/// One line per row: scene, n_*, method and effects if the rows differ in them (the heading names common
/// ones), nominal ("-": as fast as the method ran), realised mu and delta in frames/s, late frames, verdicts,
/// grade. A row with a failed trial ends in FAIL, one with a degraded trial in DEGRADED; with `coloured` (a
/// terminal) such lines are red and yellow. `mean`: the kind of mean that the rows were read with.
std::string format_certificate(const std::vector<CertificateRow>& rows, FpsMean mean, bool coloured);

}  // namespace study
