#include "libstudy/store/import/cell_match.hpp"

#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// Relative difference up to which two frame rates are the same setting.
constexpr double same_rate = 1e-9;

bool same(double a, double b) { return std::abs(a - b) <= same_rate * std::max(1.0, std::abs(b)); }

}  // namespace

void fail_at_field(const SourceTable& table, const SourceTable::Row& row, std::size_t place,
                   const std::string& problem, const std::string& mend) {
  throw base::Error(table.place(row) + ", column " + base::shortened(table.names()[place], 60),
                    "\"" + base::shortened(row.fields[place], 60) + "\" " + problem, mend);
}

double number_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place) {
  std::string text = row.fields[place];
  if (table.decimal_commas()) std::replace(text.begin(), text.end(), ',', '.');
  const auto number = base::parse_number<double>(text);
  if (!number || !std::isfinite(*number))
    fail_at_field(table, row, place, "is no number",
                  "correct the row, or leave it out by a [[row]] of the mapping");
  return *number;
}

int whole_number_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place, int low,
                    int high) {
  const double number = number_in(table, row, place);
  if (number != std::floor(number) || number < low || number > high)
    fail_at_field(table, row, place,
                  "is no whole number from " + std::to_string(low) + " to " + std::to_string(high),
                  "correct the row, or the column's name in the mapping");
  return static_cast<int>(number);
}

CellMatch::CellMatch(const Protocol& protocol, const StimulusColumns& shared, const StimulusColumns& stimulus,
                     const SourceTable& table)
    : protocol_(protocol), table_(table) {
  add_keys(shared);
  if (&shared != &stimulus) add_keys(stimulus);
}

void CellMatch::add_keys(const StimulusColumns& columns) {
  for (const char* what : {"mean_fps", "sd_fps", "scene", "method", "n_star", "effects"}) {
    const auto column = columns.columns.find(what);
    if (column != columns.columns.end()) keys_.push_back({what, table_.place_of(column->second), 0, false});
  }
  std::vector<std::string> known;
  for (const DesignFactor& factor : protocol_.design.factors) known.push_back(factor.name);
  for (const auto& [name, column] : columns.factors) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw base::Error("protocol " + protocol_.name, "has no factor " + base::shortened(name),
                        known.empty()
                            ? "remove [columns.factors] from the mapping"
                            : "correct [columns.factors] of the mapping: " + base::use_one_of(name, known));
    keys_.push_back({name, table_.place_of(column), static_cast<std::size_t>(found - known.begin()), true});
  }
}

bool CellMatch::fits(const Cell& cell, const Key& key, const std::string& text) const {
  if (key.is_factor) return level_name(protocol_.design, cell, key.factor) == text;
  if (key.what == "scene") return cell.stimulus.scene == text;
  if (key.what == "method") return cell.stimulus.method == text;
  if (key.what == "n_star") return cell.stimulus.n_star == text;
  return cell.stimulus.effects == text;
}

std::string CellMatch::words_of(const SourceTable::Row& row) const {
  std::string out;
  for (const Key& key : keys_)
    out += (out.empty() ? "" : ", ") + base::shortened(table_.names()[key.place], 40) + " \"" +
           base::shortened(row.fields[key.place], 40) + "\"";
  return out;
}

int CellMatch::cell_of(const SourceTable::Row& row) const {
  std::vector<int> found;
  const auto& cells = protocol_.design.cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool all = std::all_of(keys_.begin(), keys_.end(), [&](const Key& key) {
      if (key.what == "mean_fps" && !key.is_factor)
        return same(number_in(table_, row, key.place), cells[i].setting.mean);
      if (key.what == "sd_fps" && !key.is_factor)
        return same(number_in(table_, row, key.place), cells[i].setting.sd);
      return fits(cells[i], key, row.fields[key.place]);
    });
    if (all) found.push_back(static_cast<int>(i));
  }
  if (found.size() == 1) return found.front();
  const std::string place = table_.place(row),
                    protocol = "protocol " + protocol_.name + " " + protocol_.version;
  if (found.empty())
    throw base::Error(
        place, words_of(row) + " is no cell of " + protocol,
        "correct the row, or give the protocol that the study followed; vip-study check lists its "
        "settings");
  throw base::Error(
      place,
      (keys_.empty() ? "the mapping names no column of the setting" : words_of(row)) + ", so " +
          std::to_string(found.size()) + " cells of " + protocol + " fit",
      "name further columns of the setting in the mapping: mean_fps, sd_fps, scene, method, n_star, "
      "effects, or [columns.factors]");
}

}  // namespace study
