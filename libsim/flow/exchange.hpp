#pragma once
/// Particles of any levels for particles of one level, at equal mass in units of m_*.

#include "libsim/flow/heat_ledger.hpp"
#include "libsim/particles/free_ids.hpp"

namespace sim::SIM_BACKEND {

using ExchangeView =
    ColumnView<columns(Column::Position, Column::Id, Column::Level),
               columns(Column::Position, Column::Id, Column::Level), columns(Column::Temperature),
               columns(Column::Target, Column::History, Column::Saliency, Column::Unrest, Column::Rest)>;

class Exchange {
 public:
  /// Where the taken end.
  struct Cut {
    int taken;
    int mass;  ///< of the taken, m_*
  };

  /// Takes the first particles of `lowest_first` (`found` of them) until they and the reservoir outweigh a
  /// whole number of layers, at most `layers` of `sites` particles of `level`; removes them, appends the
  /// layers' particles and keeps the rest of their mass, less than the heaviest particle's, in the reservoir.
  /// New particles take over the ids that were freed, then the lowest that are free below the capacity; their
  /// places and velocities are the caller's to fill, and their temperatures where there are any: then what is
  /// taken is told to `heat`. Returns the layers made: fewer than asked for where the mass or the capacity
  /// does not suffice.
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
