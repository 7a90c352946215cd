#include "libsim/ptpe/ptpe_file.hpp"

#include <fmt/core.h>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {
/// Always with a point or exponent, so that TOML sees a float.
std::string exact(double value) {
  if (!std::isfinite(value)) throw std::invalid_argument("a PTPE file holds finite numbers only");
  const std::string out = base::shortest(value);
  return out.find_first_of(".e") == std::string::npos ? out + ".0" : out;
}

/// yyyy-mm-ddThh:mm:ssZ.
bool is_utc(const std::string& text) {
  constexpr std::string_view form = "dddd-dd-ddTdd:dd:ddZ";
  if (text.size() != form.size()) return false;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != form[i]) return false;
  }
  return true;
}

/// The interval of an estimate, which lies in it.
std::array<double, 2> interval(const base::TomlTable& table, const char* key, const char* of,
                               double estimate) {
  const auto ends = table.numbers(key, 2);
  if (ends[0] > ends[1]) table.fail(key, "runs downwards", "write [low, high]");
  if (estimate < ends[0] || estimate > ends[1])
    table.fail(of, std::string("lies outside its own interval, ") + key,
               "fit again: one of the two was changed");
  return {ends[0], ends[1]};
}

const char* mean_name(stats::FpsMean mean) {
  return mean == stats::FpsMean::Harmonic ? "harmonic" : "arithmetic";
}
}  // namespace

std::string describe(const PtpeFile& file) {
  std::string out =
      fmt::format("a = {:.4f} frames/s, b = {:.5f} s/frame (level {:.3g}, {} mean, {} participants",
                  file.model.a, file.model.b, file.level, mean_name(file.model.mean), file.n_participants);
  if (file.n_simulated > 0) out += fmt::format(", {} of them SIMULATED", file.n_simulated);
  return out + (file.test_data ? ", TEST DATA)" : ")");
}

PtpeFile parse_ptpe_file(std::string_view text, const std::string& name) {
  const auto root = base::parse_toml(text, name);
  if (root.integer("format") != PtpeFile::format_version) {
    root.fail("format",
              "is not the format this program reads (" + std::to_string(PtpeFile::format_version) + ")",
              "use the program that wrote the file, or fit again with this one");
  }
  const auto table = root.table("ptpe");
  PtpeFile file;
  file.model.a = table.number("a_fps", {1e-3, 1e4});
  file.model.b = table.number("b_s", {-1, 1});
  file.level = table.number("level", {1, 7});
  file.a_ci = interval(table, "a_ci95_fps", "a_fps", file.model.a);
  file.b_ci = interval(table, "b_ci95_s", "b_s", file.model.b);
  file.n_participants = static_cast<int>(table.integer("n_participants", {1, 1e6}));
  file.n_simulated = static_cast<int>(table.integer_or("n_simulated", 0, {0, 1e6}));
  if (file.n_simulated > file.n_participants) {
    table.fail("n_simulated", "is more than n_participants", "count each participant once");
  }
  file.test_data = table.boolean_or("test_data", false);
  if (table.choice("fps_mean", {"harmonic", "arithmetic"}) == "arithmetic")
    file.model.mean = stats::FpsMean::Arithmetic;
  file.protocol_sha256 = table.string("protocol_sha256");
  const bool hash = file.protocol_sha256.size() == 64 &&
                    file.protocol_sha256.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!hash) table.fail("protocol_sha256", "is not a SHA-256", "write 64 hexadecimal digits");
  file.date_utc = table.string("date_utc");
  if (!is_utc(file.date_utc)) {
    table.fail("date_utc", "is not a date in UTC", "write it as \"2026-01-31T12:00:00Z\"");
  }
  root.finish();
  return file;
}

PtpeFile read_ptpe_file(const std::filesystem::path& path) {
  return parse_ptpe_file(base::read_file(path, 1 << 20), path.string());
}

std::string format_ptpe_file(const PtpeFile& file) {
  const auto pair = [](const std::array<double, 2>& ends) {
    return "[" + exact(ends[0]) + ", " + exact(ends[1]) + "]";
  };
  std::ostringstream out;
  out << "# tau = mu - a exp(b delta), all in frames per second (ViP-Fluid, Eq. 11)\n"
      << "format = " << PtpeFile::format_version << "\n\n[ptpe]\n"
      << "a_fps = " << exact(file.model.a) << "\nb_s = " << exact(file.model.b)
      << "\nlevel = " << exact(file.level) << "\na_ci95_fps = " << pair(file.a_ci)
      << "\nb_ci95_s = " << pair(file.b_ci) << "\nn_participants = " << file.n_participants
      << "\nn_simulated = " << file.n_simulated << "\ntest_data = " << (file.test_data ? "true" : "false")
      << "\nfps_mean = " << base::toml_quoted(mean_name(file.model.mean))
      << "\nprotocol_sha256 = " << base::toml_quoted(file.protocol_sha256)
      << "\ndate_utc = " << base::toml_quoted(file.date_utc) << "\n";
  return out.str();
}

}  // namespace sim
