#include "libsim/measure/launch_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace measure {

namespace {

constexpr double vec4 = 16, number = 4, byte = 1;  // bytes; number: a float or an int
constexpr double entry = number;                   // bytes per entry of a neighbour list

/// Bytes that each pass must move, counted from its functor in libsim. Above a row, < marks the columns that
/// the pass reads and > those that it writes.
constexpr std::array table{
    // < predicted, count of its list, entries; > lambda, density. Neighbours' positions are in predicted too.
    PassBytes{"density", vec4 + number + 2 * number, entry, true},
    // < predicted, lambda, count, entries; > the next positions. With momentum, which repeats a share of the
    // last displacement, the pass also reads the old values of the next positions.
    PassBytes{"displacement", vec4 + number + number + vec4, entry, true},
    // < predicted; > count, entries.
    PassBytes{"list neighbours", vec4 + number, entry, true},
    // < position, velocity, density, count, entries; > the next velocity. With levels the pass
    // also reads the columns PredictedNext and Ease.
    PassBytes{"xsph", 2 * vec4 + number + number + vec4, entry, true},
    // < age, count, entries; > ease. The pass reads positions only near particles that a split or merge made.
    PassBytes{"ease", byte + number + number, entry, true},
    // < position, velocity; > position, velocity, predicted.
    PassBytes{"predict", 5 * vec4, 0, false},
    // < position, predicted, velocity; > position, velocity. With levels the pass also
    // writes PredictedNext.
    PassBytes{"velocity", 5 * vec4, 0, false},
    // < predicted, density.
    PassBytes{"gather cells", vec4 + number, 0, false},
    // < predicted; > the next positions.
    PassBytes{"shift", 2 * vec4, 0, true},
    // < predicted; > cell, arrival.
    PassBytes{"count cells", vec4 + 2 * number, 0, false},
    // < cell, arrival; > index of the particle in each slot.
    PassBytes{"place by cell", 3 * number, 0, false},
    // < index of the particle in each slot, cell, id; > order.
    PassBytes{"order within cells", 4 * number, 0, false},
    // < order; < and > position, predicted, velocity, id, level. With levels there are more
    // columns.
    PassBytes{"reorder", number + 2 * (3 * vec4 + number + byte), 0, false},
};

}  // namespace

std::span<const PassBytes> pass_bytes() { return table; }

std::optional<double> least_bytes(const std::string& label, const PassWater& water) {
  const auto pass =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return label == row.label; });
  if (pass == table.end()) return {};
  const double particles = water.particles * (pass->solved_only ? water.solved_share : 1);
  if (pass->a_neighbour > 0 && !(water.listed > 0)) return {};
  return particles * (pass->a_particle + pass->a_neighbour * water.listed);
}

std::optional<PassFloor> floor_of(const std::string& label, double launches_a_frame, double ms_a_frame,
                                  const PassWater& water, double gb_s) {
  const auto bytes = least_bytes(label, water);
  if (!bytes || !(*bytes > 0) || !(launches_a_frame > 0)) return {};
  PassFloor out{.bytes_a_frame = *bytes * launches_a_frame};
  out.ms_a_frame = out.bytes_a_frame / (gb_s * 1e6);
  out.times = ms_a_frame / out.ms_a_frame;
  return out;
}

void LaunchSums::add(const std::vector<sim::LaunchTime>& stretch) {
  for (const auto& pass : stretch) {
    passes_[pass.label].launches += pass.launches;
    passes_[pass.label].ms += pass.ms;
  }
}

base::Json launches_json(const std::vector<sim::LaunchTime>& passes, int frames, const PassWater& water,
                         double gb_s) {
  base::Json out = base::Json::array();
  for (const auto& pass : passes) {
    const double launches = static_cast<double>(pass.launches) / frames, ms = pass.ms / frames;
    const auto least = floor_of(pass.label, launches, ms, water, gb_s);
    const auto or_none = [&](double value) { return least ? base::Json(value) : base::Json(); };
    const PassFloor floor = least.value_or(PassFloor{});
    out.push_back({{"pass", pass.label},
                   {"launches_a_frame", launches},
                   {"ms_a_frame", ms},
                   {"bytes_a_frame", or_none(floor.bytes_a_frame)},
                   {"floor_ms_a_frame", or_none(floor.ms_a_frame)},
                   {"times_floor", or_none(floor.times)}});
  }
  return out;
}

std::string launch_lines(const base::Json& launches, double gb_s) {
  std::string out = fmt::format("  bandwidth    {:8.1f} GB/s of a copy in memory, read plus written\n", gb_s);
  out += fmt::format("  {:<32} {:>10} {:>8} {:>10} {:>10} {:>11}\n", "pass", "ms a frame", "launches",
                     "least MB", "floor ms", "times floor");
  const auto cell = [](const base::Json& value, double scale, int digits) {
    return value.is_null() ? std::string("-") : fmt::format("{:.{}f}", value.get<double>() * scale, digits);
  };
  for (const auto& pass : launches) {
    out += fmt::format("  {:<32} {:>10} {:>8} {:>10} {:>10} {:>11}\n", pass["pass"].get<std::string>(),
                       cell(pass["ms_a_frame"], 1, 4), cell(pass["launches_a_frame"], 1, 1),
                       cell(pass["bytes_a_frame"], 1e-6, 2), cell(pass["floor_ms_a_frame"], 1, 4),
                       cell(pass["times_floor"], 1, 2));
  }
  return out;
}

}  // namespace measure
