#include "libsim/ptpe/ptpe_file.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "stats/base/file.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {
/// Shortest exact text of a number; always with a point or exponent, so that TOML reads a float.
std::string exact(double value) {
  if (!std::isfinite(value))
    throw std::invalid_argument(
        "format_ptpe_file: a number of the fit is not finite; pass a fit with finite numbers only");
  const std::string out = base::shortest(value);
  return out.find_first_of(".e") == std::string::npos ? out + ".0" : out;
}

/// True if the text has the form yyyy-mm-ddThh:mm:ssZ.
bool is_utc(const std::string& text) {
  constexpr std::string_view form = "dddd-dd-ddTdd:dd:ddZ";
  if (text.size() != form.size()) return false;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != form[i]) return false;
  }
  return true;
}

/// Reads the interval of an estimate; the interval must contain the estimate.
std::array<double, 2> interval(const base::TomlTable& table, const char* key, const char* of,
                               double estimate) {
  const auto ends = table.numbers(key, 2);
  if (ends[0] > ends[1]) table.fail(key, "has its low end above its high end", "write [low, high]");
  if (estimate < ends[0] || estimate > ends[1])
    table.fail(of, "= " + base::shortest(estimate) + " lies outside its own interval, " + key,
               "fit again with vip-stats fit-ptpe: one of the two was changed");
  return {ends[0], ends[1]};
}

/// Reads the band's lists of a file of format 2; each list has one entry per delta.
std::vector<PtpeBandPoint> band_of(const base::TomlTable& table, const stats::PtpeModel& model) {
  constexpr base::Range rate{1e-6, 1e9};
  const auto deltas = table.numbers("band_delta_fps", 0, {0, 1e4});
  if (deltas.empty())
    table.fail("band_delta_fps", "is empty",
               "fit again with vip-stats fit-ptpe: a band has at least one entry");
  const auto lows = table.numbers("band_low95_fps", deltas.size(), rate);
  const auto highs = table.numbers("band_high95_fps", deltas.size(), rate);
  const auto away = table.numbers("band_out_of_reach_fps");
  std::vector<PtpeBandPoint> out;
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    if (i > 0 && deltas[i] <= deltas[i - 1])
      table.fail_at("band_delta_fps", i, "is not above the one before it", "write them ascending");
    const double mu = model.a * std::exp(model.b * deltas[i]);
    if (!(lows[i] <= mu && mu <= highs[i]))
      table.fail_at("band_low95_fps", i, "and band_high95_fps at this delta do not enclose a exp(b delta)",
                    "fit again with vip-stats fit-ptpe: one of them was changed");
    const bool in_reach = std::find(away.begin(), away.end(), deltas[i]) == away.end();
    out.push_back({deltas[i], {lows[i], highs[i]}, in_reach});
  }
  for (std::size_t i = 0; i < away.size(); ++i) {
    if (std::find(deltas.begin(), deltas.end(), away[i]) == deltas.end() || (i > 0 && away[i] <= away[i - 1]))
      table.fail_at("band_out_of_reach_fps", i, "is none of band_delta_fps or not above the one before it",
                    "list deltas of the band, ascending");
  }
  return out;
}

/// The largest half width of the band (PtpeBandPoint::mu), as a share of a exp(b delta) at the same delta.
double widest(const PtpeFile& file) {
  double out = 0;
  for (const auto& point : file.band)
    out = std::max(out,
                   (point.mu[1] - point.mu[0]) / 2 / (file.model.a * std::exp(file.model.b * point.delta)));
  return out;
}

const char* mean_name(stats::FpsMean mean) {
  return mean == stats::FpsMean::Harmonic ? "harmonic" : "arithmetic";
}
}  // namespace

std::string describe(const PtpeFile& file) {
  std::string out = fmt::format("a = {:.4f} frames/s, b = {:.5f} s/frame (level {:.3g}, {} mean, ",
                                file.model.a, file.model.b, file.level, mean_name(file.model.mean));
  if (!file.band.empty())
    out += fmt::format("mu uncertain by up to +-{:.0f} % at delta {:g} to {:g}, ", 100 * widest(file),
                       file.band.front().delta, file.band.back().delta);
  out += file.participant.empty()
             ? fmt::format("{} participant{}", file.n_participants, file.n_participants == 1 ? "" : "s")
             : "the curve of one person, " + base::for_terminal(file.participant);
  if (file.n_simulated > 0) out += fmt::format(", {} of them SIMULATED", file.n_simulated);
  return out + (file.test_data ? ", TEST DATA)" : ")");
}

PtpeFile parse_ptpe_file(std::string_view text, const std::string& name) {
  const auto root = base::parse_toml(text, name);
  const auto format = root.integer("format");
  if (format < 1 || format > PtpeFile::format_version) {
    root.fail("format",
              "= " + std::to_string(format) + " is not a format this program reads (1 to " +
                  std::to_string(PtpeFile::format_version) + ")",
              "use the version of ViP-Lab that wrote the file, or fit again with vip-stats fit-ptpe of this "
              "version");
  }
  const auto table = root.table("ptpe");
  PtpeFile file;
  file.model.a = table.number("a_fps", {1e-3, 1e4});
  file.model.b = table.number("b_s", {-1, 1});
  file.level = table.number("level", {1, 7});
  file.a_ci = interval(table, "a_ci95_fps", "a_fps", file.model.a);
  file.b_ci = interval(table, "b_ci95_s", "b_s", file.model.b);
  if (format > 1) file.band = band_of(table, file.model);
  file.n_participants = static_cast<int>(table.integer("n_participants", {1, 1e6}));
  file.n_simulated = static_cast<int>(table.integer_or("n_simulated", 0, {0, 1e6}));
  if (file.n_simulated > file.n_participants) {
    table.fail("n_simulated",
               "= " + std::to_string(file.n_simulated) +
                   " is more than n_participants = " + std::to_string(file.n_participants),
               "count each participant once");
  }
  file.test_data = table.boolean_or("test_data", false);
  file.participant = table.string_or("participant", "");
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
  const auto list = [&](auto value) {
    std::string text;
    for (const auto& point : file.band)
      if (const std::optional<double> one = value(point)) text += (text.empty() ? "" : ", ") + exact(*one);
    return "[" + text + "]";
  };
  using Point = const PtpeBandPoint&;
  using Listed = std::optional<double>;
  std::ostringstream out;
  out << "# tau = mu - a exp(b delta), all in frames per second (ViP-Fluid, Eq. 11)\n"
      << "format = " << (file.band.empty() ? 1 : PtpeFile::format_version) << "\n\n[ptpe]\n"
      << "a_fps = " << exact(file.model.a) << "\nb_s = " << exact(file.model.b)
      << "\nlevel = " << exact(file.level) << "\na_ci95_fps = " << pair(file.a_ci)
      << "\nb_ci95_s = " << pair(file.b_ci);
  if (!file.band.empty())
    out << "\nband_delta_fps = " << list([](Point p) -> Listed { return p.delta; })
        << "\nband_low95_fps = " << list([](Point p) -> Listed { return p.mu[0]; })
        << "\nband_high95_fps = " << list([](Point p) -> Listed { return p.mu[1]; })
        << "\nband_out_of_reach_fps = "
        << list([](Point p) { return p.in_reach ? Listed() : Listed(p.delta); });
  out << "\nn_participants = " << file.n_participants << "\nn_simulated = " << file.n_simulated
      << "\ntest_data = " << (file.test_data ? "true" : "false")
      << (file.participant.empty() ? "" : "\nparticipant = " + base::toml_quoted(file.participant))
      << "\nfps_mean = " << base::toml_quoted(mean_name(file.model.mean))
      << "\nprotocol_sha256 = " << base::toml_quoted(file.protocol_sha256)
      << "\ndate_utc = " << base::toml_quoted(file.date_utc) << "\n";
  return out.str();
}

}  // namespace sim
