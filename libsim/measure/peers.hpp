#pragma once
/// Times per step of other fluid programs (peers) and of ViP-Lab, in the same scene with the same time step.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libsim/measure/cells.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// One row of data/peers.csv: a run of another program. Values that were not recorded are empty.
struct PeerRow {
  std::string program, solver;
  std::int64_t particles = 0;
  double dt_s = 0;
  std::optional<int> iterations;  ///< per step
  std::string backend;
  std::optional<int> threads;
  double ms_a_step = 0;
  std::optional<double> density_error_percent;
  std::string source;  ///< who measured it, and on which machine
};
/// base::Error at file:line for a malformed row, and for a file without rows.
std::vector<PeerRow> read_peers(const std::filesystem::path& path);

/// ViP-Lab's run of the same scene with the same time step. ms_p95: 95th percentile of ms per step;
/// neighbours, substeps: means.
struct OurRow {
  PeerRow as_peer;  ///< ms_a_step is the mean; source is the machine
  double ms_p95 = 0, neighbours = 0, substeps = 0;
};
/// Makes the row from the result of run_frames(). machine: empty if unknown.
OurRow our_row(const base::Json& result, double dt_s, int iterations, const std::string& machine);

/// The peers' rows, then ours.
figures::TextTable peers_table(const std::vector<PeerRow>& peers, const OurRow& ours);
/// A note on how to read the table, with a warning unless every peer's source names our machine.
std::string peers_note(const std::vector<PeerRow>& peers, const OurRow& ours);
base::Json to_json(const std::vector<PeerRow>& peers);

}  // namespace measure
