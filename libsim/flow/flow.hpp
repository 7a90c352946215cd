#pragma once
/// Water that enters and leaves a run through nozzles and outlets, and its heat.

#include <cmath>
#include <cstdint>
#include <vector>

#include "libsim/exec/space.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/walls.hpp"
#include "libsim/scene/nozzle.hpp"

namespace sim::SIM_BACKEND {

/// Heat that entered and left the water since the run began, divided by the water's specific heat: mass in
/// m_* (the mass of a particle of level 0) times kelvin above the reference. Integer multiples of `unit`, so
/// that the order of the threads does not matter; negative values in two's complement.
struct HeatLedger {
  std::uint64_t poured;   ///< with the water that nozzles added
  std::uint64_t taken;    ///< with the water that nozzles took from the corners
  std::uint64_t drained;  ///< through outlets
  std::uint64_t walls;    ///< from walls with a given temperature

  static constexpr int unit_bits = 24;
  static constexpr double unit = 1.0 / (1 << unit_bits);
  SIM_FN static std::uint64_t of(float kelvin, int level) {
    const float units = kelvin * (static_cast<float>(1 << unit_bits) * static_cast<float>(1 << level));
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(rintf(units)));
  }
  static double amount(std::uint64_t entry) {
    return unit * static_cast<double>(static_cast<std::int64_t>(entry));
  }
};

/// The four corner columns of a tank: x and z each lie in [low, low + edge] or [high - edge, high]; y is
/// free.
struct Corners {
  Vec3 low{}, high{};
  float edge = 0;

  SIM_FN bool hold(Vec3 x) const {
    const bool side_x = x.x < low.x + edge || x.x > high.x - edge;
    const bool side_z = x.z < low.z + edge || x.z > high.z - edge;
    return side_x && side_z && all_finite(x);
  }
};

/// Finds the water that nozzles take: the particles in the four corner columns of the tank, the lowest along
/// gravity first.
class CornerColumns {
 public:
  /// Lists the particles in the corners by their height along `up`, lowest first, ties by id, so that the
  /// result does not depend on the particles' order in memory. Returns their number, read back from the
  /// device.
  int find(Reads<Column::Position, Column::Id> particles, const Corners& corners, Vec3 up);
  /// Indices of the particles found by `find`.
  const int* lowest_first() const { return order_.data(); }
  std::size_t bytes() const;

 private:
  Scanner scanner_;
  Sorter sorter_;
  Array<int> inside_, rank_, order_;
  Array<std::uint64_t> keys_;
};

using ExchangeView =
    ColumnView<columns(Column::Position, Column::Id, Column::Level),
               columns(Column::Position, Column::Id, Column::Level), columns(Column::Temperature),
               columns(Column::Target, Column::History, Column::Saliency, Column::Unrest, Column::Drift)>;

/// Exchanges particles of any levels for particles of one level, with equal mass in units of m_*.
class Exchange {
 public:
  /// Number of particles taken from the front of `lowest_first` (see run).
  struct Cut {
    int taken;
    int mass;  ///< mass of these particles, m_*
  };

  /// Takes particles from the front of `lowest_first` (which has `found` entries) until their mass and the
  /// reservoir suffice for a whole number of layers, at most `layers`. A layer has `sites` particles of
  /// `level`. Removes the taken particles, appends the layers' particles and stores the remaining mass, less
  /// than the heaviest particle's, in the reservoir. New particles get the freed ids, then the lowest free
  /// ids below the capacity. The caller sets their positions and velocities, and their temperatures if they
  /// have any. Unless `heat` is null, the heat of the taken particles is added to it. Returns the number of
  /// layers made: fewer than requested if the mass or the capacity does not suffice.
  int run(Particles& particles, const LevelSupports& supports, const int* lowest_first, int found, int sites,
          int layers, int level, std::int64_t& reservoir, HeatLedger* heat);
  std::size_t bytes() const;

 private:
  Cut cut_at(std::int64_t need);
  Scanner scanner_;
  Array<int> mass_, mass_sum_, kept_, kept_sum_, order_, id_, free_, free_sum_, free_ids_;
  Array<Cut> cut_;
};

/// The nozzles of a run, and the amounts of water that they took and added.
struct Jets {
  std::vector<Nozzle> nozzles;
  /// Per nozzle: the part of the jet that was due before this frame, including layers that could not be
  /// poured.
  std::vector<Poured> before;
  double finest_spacing_m = 0;  ///< d_*, the spacing of particles of level 0
  double frame_dt_s = 0;        ///< > 0
  Corners corners;
  /// True if the level of new layers is the median target level of the particles near the mouth.
  bool by_target = false;
  int level = 0;         ///< level of the particles that are added
  int frame = 0;         ///< number of the frame that begins
  bool pouring = false;  ///< true if this frame started with new layers
  CornerColumns columns;
  Exchange exchange;
  Array<int> mass_by_target;   ///< mass of the particles near a mouth by target level, m_*
  std::int64_t reservoir = 0;  ///< mass taken from the corners and not yet poured, in m_*
  std::int64_t poured = 0;     ///< mass poured since the run began, in m_*
  std::int64_t made = 0;       ///< particles added by pouring since the run began
  std::int64_t taken = 0;      ///< particles taken from the corners since the run began
  /// Layers that were due and not poured: the corners had too little mass, or the capacity was reached.
  std::uint64_t waited = 0;
};

using OutflowView = ColumnView<columns(Column::Position, Column::Level),
                               columns(Column::Position, Column::Velocity, Column::Id, Column::Level,
                                       Column::Predicted, Column::Density),
                               columns(Column::Temperature)>;

/// Removes particles that left through outlets: the particles on the far side of the plane of a wall that has
/// an opening.
class Outflow {
 public:
  /// Number of particles, and their mass in units of m_*.
  struct Amount {
    int particles, mass;
  };

  /// Removes the particles that passed an opening; the others keep their order and their densities of the
  /// last projection. The removed ids become free. The heat of the removed particles is added to `heat`, if
  /// not null. Waits for a read-back from the device.
  Amount run(Particles& particles, OutflowView view, const Walls& walls, HeatLedger* heat);
  std::size_t bytes() const;

 private:
  Scanner scanner_;
  Array<int> stays_, sums_, order_;
  Array<float> density_;
  Array<Amount> left_;
};

/// Water that left through outlets since the run began.
struct Drained {
  std::int64_t particles = 0;
  std::int64_t mass = 0;  ///< in m_*
};

}  // namespace sim::SIM_BACKEND
