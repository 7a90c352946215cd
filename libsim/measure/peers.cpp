#include "libsim/measure/peers.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <type_traits>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/text.hpp"

namespace measure {

namespace {

constexpr std::size_t most_table_bytes = 1 << 20;
constexpr const char* head =
    "program,solver,particles,dt_s,iterations,backend,threads,ms_a_step,density_error_percent,source";
constexpr std::size_t columns = 10;

/// Reads the cells of one line; base::Error with the column's name at the first wrong cell.
class Cells {
 public:
  Cells(std::string place, const std::string& line)
      : place_(std::move(place)), cells_(base::split(line + ",")) {  // the comma preserves an empty last cell
    if (cells_.size() != columns)
      fail("has " + std::to_string(cells_.size()) + " cells where " + std::to_string(columns) + " belong");
  }

  std::string word(std::size_t column, const char* name) const {
    if (cells_[column].empty() || !base::is_plain_line(cells_[column]))
      fail(std::string(name) + " is missing, or contains a control character or bytes that are not UTF-8");
    return cells_[column];
  }
  template <class Number>
  Number above_zero(std::size_t column, const char* name) const {
    return number<Number>(column, name, false);
  }
  template <class Number>
  std::optional<Number> if_known(std::size_t column, const char* name) const {
    if (cells_[column].empty()) return {};
    return number<Number>(column, name, true);
  }

 private:
  template <class Number>
  Number number(std::size_t column, const char* name, bool zero_too) const {
    const std::string& text = cells_[column];
    const auto value = base::parse_number<Number>(text);
    if (!value || !std::isfinite(static_cast<double>(*value)) || *value < 0 || (*value == 0 && !zero_too))
      fail(std::string(name) + " \"" + base::shortened(text) + "\" is no " +
           (std::is_integral_v<Number> ? "whole " : "") + "number " + (zero_too ? "from 0 on" : "above 0"));
    return *value;
  }
  [[noreturn]] void fail(const std::string& problem) const {
    throw base::Error(place_, problem, std::string("write a row of ") + head);
  }

  std::string place_;
  std::vector<std::string> cells_;
};

PeerRow row_of(const Cells& cells) {
  PeerRow out;
  out.program = cells.word(0, "program");
  out.solver = cells.word(1, "solver");
  out.particles = cells.above_zero<std::int64_t>(2, "particles");
  out.dt_s = cells.above_zero<double>(3, "dt_s");
  out.iterations = cells.if_known<int>(4, "iterations");
  out.backend = cells.word(5, "backend");
  out.threads = cells.if_known<int>(6, "threads");
  out.ms_a_step = cells.above_zero<double>(7, "ms_a_step");
  out.density_error_percent = cells.if_known<double>(8, "density_error_percent");
  out.source = cells.word(9, "source");
  return out;
}

template <class Value>
std::string or_dash(const std::optional<Value>& value) {
  return value ? figures::shortest(static_cast<double>(*value)) : "-";
}

std::vector<std::string> cells_of(const PeerRow& row, const std::string& p95, const std::string& neighbours) {
  return {row.program,
          row.solver,
          std::to_string(row.particles),
          figures::shortest(row.dt_s),
          or_dash(row.iterations),
          row.backend,
          or_dash(row.threads),
          figures::shortest(row.ms_a_step),
          p95,
          or_dash(row.density_error_percent),
          neighbours,
          row.source.empty() ? "-" : figures::in_a_cell(row.source)};
}

bool on_our_machine(const std::vector<PeerRow>& peers, const std::string& machine) {
  return !machine.empty() && std::all_of(peers.begin(), peers.end(), [&](const PeerRow& peer) {
    return peer.source.find(machine) != std::string::npos;
  });
}

}  // namespace

std::vector<PeerRow> read_peers(const std::filesystem::path& path) {
  std::istringstream lines(base::read_file(path, most_table_bytes));
  std::string line;
  std::getline(lines, line);
  if (line != head)
    throw base::Error(path.string() + ":1", "does not name the columns of peers",
                      std::string("begin the file with ") + head);
  std::vector<PeerRow> out;
  int number = 2;
  for (; std::getline(lines, line); ++number)
    out.push_back(row_of(Cells(path.string() + ":" + std::to_string(number), line)));
  if (out.empty())
    throw base::Error(path.string() + ":" + std::to_string(number), "the first row of a peer is missing",
                      std::string("write a row of ") + head);
  return out;
}

OurRow our_row(const base::Json& result, double dt_s, int iterations, const std::string& machine) {
  OurRow out;
  PeerRow& row = out.as_peer;
  row.program = "ViP-Lab";
  row.solver = "PBF";
  row.particles = result["particles"].get<std::int64_t>();
  row.dt_s = dt_s;
  row.iterations = iterations;
  row.backend = result["backend"].get<std::string>();
  if (row.backend == "cpu") row.threads = result["threads"].get<int>();
  row.ms_a_step = result["solve_ms_mean"].get<double>();
  row.density_error_percent = 100 * result["density_error_mean"].get<double>();
  row.source = machine;
  out.ms_p95 = result["solve_ms_p95"].get<double>();
  out.neighbours = result["neighbours_mean"].get<double>();
  out.substeps = result["substeps_mean"].get<double>();
  return out;
}

figures::TextTable peers_table(const std::vector<PeerRow>& peers, const OurRow& ours) {
  figures::TextTable out{{"program", "solver", "particles", "dt s", "iterations", "backend", "threads",
                          "ms a step", "p95 ms", "density error %", "neighbours", "source or machine"},
                         {}};
  for (const auto& peer : peers) out.rows.push_back(cells_of(peer, "-", "-"));
  out.rows.push_back(
      cells_of(ours.as_peer, figures::shortest(ours.ms_p95), figures::shortest(ours.neighbours)));
  return out;
}

std::string peers_note(const std::vector<PeerRow>& peers, const OurRow& ours) {
  std::string out = "ms a step: ours is the mean. Our step took " + figures::number(ours.substeps, 2) +
                    " substeps on average, each with the iterations of the table.";
  if (!on_our_machine(peers, ours.as_peer.source))
    out += "\nNot every peer's row names our machine as its source. Times compare on one machine only.";
  return out;
}

base::Json to_json(const std::vector<PeerRow>& peers) {
  base::Json out = base::Json::array();
  for (const auto& peer : peers) {
    out.push_back({{"program", peer.program},
                   {"solver", peer.solver},
                   {"particles", peer.particles},
                   {"dt_s", peer.dt_s},
                   {"iterations", peer.iterations},
                   {"backend", peer.backend},
                   {"threads", peer.threads},
                   {"ms_a_step", peer.ms_a_step},
                   {"density_error_percent", peer.density_error_percent},
                   {"source", peer.source}});
  }
  return out;
}

}  // namespace measure
