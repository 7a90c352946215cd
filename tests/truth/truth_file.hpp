#pragma once
/// Files in data/truth, or in the folder that VIP_TRUTH_DIR names: an experiment or a closed form as columns
/// of numbers under a header that describes them. docs/results.md has the format.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace truth_test {

inline constexpr double gravity = 9.81;  ///< m/s2, for every experiment

/// A column, and the factor from a run's dimensionless value to the column's.
struct Axis {
  std::string column;
  double factor = 1;
};

struct TruthFile {
  std::filesystem::path path;
  std::string quantity;
  std::map<std::string, std::pair<std::string, int>> keys;  ///< value and line
  std::map<std::string, std::vector<double>> columns;
  int header_line = 0;  ///< line of the column names

  std::string name() const { return path.filename().string(); }
  [[noreturn]] void fail(int line, const std::string& problem, const std::string& mend) const {
    throw base::Error(path.string() + ":" + std::to_string(line), problem, mend);
  }
  bool has(const std::string& key) const { return keys.count(key) > 0; }
  const std::string& text(const std::string& key) const {
    if (!has(key))
      fail(1, "the header lacks '" + key + "'", "add a line '# " + key + ": ...' (docs/results.md)");
    return keys.at(key).first;
  }
  double number(const std::string& key) const {
    const std::string& value = text(key);
    char* end = nullptr;
    const double out = std::strtod(value.c_str(), &end);
    if (end == value.c_str() || *end != 0 || !(out > 0) || !std::isfinite(out))
      fail(keys.at(key).second, key + " is '" + value + "', not a number above 0", "write a number");
    return out;
  }
  /// The method's gate: "gate", or "gate_ours" for Ours if the file has it. Nullopt if the file says "none":
  /// report only.
  std::optional<double> gate(const std::string& key = "gate", bool ours = false) const {
    const std::string mine = ours && has(key + "_ours") ? key + "_ours" : key;
    if (text(mine) == "none") return std::nullopt;
    return number(mine);
  }
  const std::vector<double>& column(const std::string& wanted) const {
    const auto found = columns.find(wanted);
    if (found == columns.end())
      fail(header_line, "there is no column '" + wanted + "'", "name one of the columns so");
    return found->second;
  }
  /// "T = t sqrt(2 g / length)": the column's value is factor * t sqrt(g / length). "T = t": seconds.
  Axis time() const {
    static const std::regex form(R"((\w+) = t( sqrt\((?:([0-9.]+) )?g / length\))?)");
    const auto [name, number, scaled] = match("x", form, "T = t sqrt(2 g / length)");
    return {name, scaled ? std::sqrt(number) : std::sqrt(this->number("length_m") / gravity)};
  }
  /// "P = p / (rho g length)": the column's name; pressures have no other scale.
  std::string pressure() const {
    static const std::regex form(R"((\w+) = (p / \(rho g length\))(x?))");
    return match("y", form, "P = p / (rho g length)").name;
  }
  /// "H = h / (2 length)": the column's value is factor * h / length. "H = h": metres.
  Axis length() const {
    static const std::regex form(R"((\w+) = \w+( / (?:length|\(([0-9.]+) length\)))?)");
    const auto [name, number, scaled] = match("y", form, "Z = x / length");
    return {name, scaled ? 1 / number : this->number("length_m")};
  }

 private:
  struct Match {
    std::string name;
    double number;
    bool scaled;
  };
  Match match(const std::string& key, const std::regex& form, const std::string& example) const {
    std::smatch found;
    const std::string& value = text(key);
    if (!std::regex_match(value, found, form))
      fail(keys.at(key).second, key + " is '" + value + "'", "write it like '" + example + "'");
    column(found[1]);
    return {found[1], found[3].length() > 0 ? std::stod(found[3]) : 1, found[2].matched};
  }
};

/// The quantities that tests measure; one test file covers each.
inline const std::vector<std::string>& quantities() {
  static const std::vector<std::string> all{
      "column_at_rest", "dam_front",  "dam_height",       "dam_profile",   "draining",     "elliptical_drop",
      "free_fall",      "lamb_oseen", "oscillating_drop", "standing_wave", "taylor_green", "wall_pressure"};
  return all;
}

/// base::Error at file:line if the quantity, the gate or the source is missing, the quantity or a key is
/// unknown, a key comes twice, a pressure's sensor has no height, a sensor's place is not a number above 0,
/// there are no rows, a row's columns differ from the header's, or a cell is not a number.
inline TruthFile parse_truth(const std::filesystem::path& path, const std::string& bytes) {
  static const std::vector<std::string> known{"quantity",
                                              "source",
                                              "licence",
                                              "gate",
                                              "gate_ours",
                                              "gate_amplitude",
                                              "gate_amplitude_ours",
                                              "gate_pressure",
                                              "gate_pressure_ours",
                                              "gate_plateau",
                                              "gate_plateau_ours",
                                              "plateau_from",
                                              "plateau_to",
                                              "scene",
                                              "sensor_height_m",
                                              "sensor_across_m",
                                              "sensor_size_m",
                                              "x",
                                              "y",
                                              "length_m",
                                              "shift",
                                              "viscosity"};
  static const std::regex key_line(R"(# ([a-z_]+): +(.*\S)\s*)");
  TruthFile out;
  out.path = path;
  std::vector<std::string> names;
  std::istringstream in(bytes);
  int line = 0;
  for (std::string row; std::getline(in, row);) {
    ++line;
    if (!row.empty() && row.back() == '\r') row.pop_back();
    std::smatch found;
    if (std::regex_match(row, found, key_line)) {
      const std::string key = found[1];
      if (std::find(known.begin(), known.end(), key) == known.end())
        out.fail(line, "'" + key + "' is no key of a header",
                 "use a key that docs/results.md lists, or begin a remark with a capital");
      if (!out.keys.try_emplace(key, found[2], line).second)
        out.fail(line, "'" + key + "' comes twice", "keep one");
    }
    if (row.empty() || row[0] == '#') continue;
    std::vector<std::string> cells;
    std::istringstream split(row);
    for (std::string cell; std::getline(split, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      out.header_line = line;
      continue;
    }
    if (cells.size() != names.size())
      out.fail(line,
               std::to_string(cells.size()) + " cells where the header has " + std::to_string(names.size()),
               "give each row every column");
    for (std::size_t c = 0; c < cells.size(); ++c) {
      char* end = nullptr;
      const double value = std::strtod(cells[c].c_str(), &end);
      if (end == cells[c].c_str() || *end != 0 || !std::isfinite(value))
        out.fail(line, "'" + cells[c] + "' in column " + names[c] + " is not a number", "write a number");
      out.columns[names[c]].push_back(value);
    }
  }
  if (out.columns.empty()) out.fail(line, "there are no rows", "add a line of names and rows of numbers");
  out.quantity = out.text("quantity");
  if (std::find(quantities().begin(), quantities().end(), out.quantity) == quantities().end())
    out.fail(out.keys.at("quantity").second, "no test measures '" + out.quantity + "'",
             "write one of the quantities that docs/results.md lists");
  out.gate();
  out.text("source");
  if (out.quantity == "wall_pressure") out.text("sensor_height_m");
  for (const char* place : {"sensor_height_m", "sensor_across_m", "sensor_size_m"})
    if (out.has(place)) out.number(place);
  return out;
}

/// data/truth, or the folder that VIP_TRUTH_DIR names.
inline std::filesystem::path truth_folder() {
  const char* named = std::getenv("VIP_TRUTH_DIR");
  return named && *named ? std::filesystem::path(named) : base::resource("data/truth");
}

/// The *.csv files of the folder, sorted by name. base::Error if there are none.
inline std::vector<std::filesystem::path> truth_paths() {
  std::vector<std::filesystem::path> out;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(truth_folder(), none))
    if (entry.path().extension() == ".csv") out.push_back(entry.path());
  if (out.empty())
    throw base::Error(truth_folder().string(), "holds no file *.csv",
                      "set VIP_TRUTH_DIR to a folder that does");
  std::sort(out.begin(), out.end());
  return out;
}

inline TruthFile read_truth(const std::filesystem::path& path) {
  return parse_truth(path, base::read_file(path, 1 << 20));
}

/// The files of a quantity. Skips malformed ones: another test reads them all.
inline std::vector<TruthFile> truth_of(const std::string& quantity) {
  std::vector<TruthFile> out;
  for (const auto& path : truth_paths()) {
    try {
      TruthFile file = read_truth(path);
      if (file.quantity == quantity) out.push_back(std::move(file));
    } catch (const base::Error&) {
    }
  }
  return out;
}

}  // namespace truth_test
