#pragma once
/// Exchanges particles of any levels for particles of one level, with equal mass in units of m_*.

#include "libsim/flow/heat_ledger.hpp"
#include "libsim/particles/free_ids.hpp"

namespace sim::SIM_BACKEND {

using ExchangeView =
    ColumnView<columns(Column::Position, Column::Id, Column::Level),
               columns(Column::Position, Column::Id, Column::Level), columns(Column::Temperature),
               columns(Column::Target, Column::History, Column::Saliency, Column::Unrest, Column::Rest)>;

class Exchange {
 public:
  /// End of the taken particles in the list.
  struct Cut {
    int taken;
    int mass;  ///< of the taken particles, m_*
  };

  /// Takes the first particles of `lowest_first` (`found` of them) until they and the reservoir suffice for a
  /// whole number of layers, at most `layers` of `sites` particles of `level`. Removes them, appends the
  /// layers' particles and stores the remaining mass, less than the heaviest particle's, in the reservoir.
  /// New particles get the freed ids, then the lowest free ids below the capacity. The caller sets their
  /// positions and velocities, and their temperatures if they have any; the heat of the taken particles is
  /// then added to `heat`. Returns the number of layers made: fewer than requested if the mass or the
  /// capacity does not suffice.
  int run(Particles& particles, const LevelSupports& supports, const int* lowest_first, int found, int sites,
          int layers, int level, std::int64_t& reservoir, HeatLedger* heat);
  std::size_t bytes() const;

 private:
  Cut cut_at(std::int64_t need);
  Scanner scanner_;
  Array<int> mass_, mass_sum_, kept_, kept_sum_, order_, id_, free_, free_sum_, free_ids_;
  Array<Cut> cut_;
};

}  // namespace sim::SIM_BACKEND
