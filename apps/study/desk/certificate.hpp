#pragma once
/// The timing certificate as the experimenter reads it.

#include <string>
#include <vector>

#include "libstudy/store/status.hpp"

namespace apps {

/// One line a row: scene, n_*, method and effects as far as the rows differ in them (the heading names what
/// all share), nominal ("-": as fast as the method ran), realised mu and delta in frames/s, late frames,
/// verdicts, grade. A row with a failed trial ends in FAIL, one with a degraded trial in DEGRADED; with
/// `coloured` (a terminal) such lines are red and yellow. `mean` is the one that the rows were read with.
std::string format_certificate(const std::vector<study::CertificateRow>& rows, study::FpsMean mean,
                               bool coloured);

}  // namespace apps
