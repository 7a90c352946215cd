#pragma once
/// The temporal feature before occlusion, f_T gamma_t of ViP-Fluid Eq. 6: spatial change of density and
/// velocity around a particle.

#include "libsim/methods/preset.hpp"
#include "libsim/neighbors/neighbour_list.hpp"

namespace sim::SIM_BACKEND {

/// Inputs and outputs of the gradients, whatever their reach (GradientReach). The epsilons are added to the
/// divisors of Eq. 6, density and speed.
struct GradientFields {
  const Vec4* position;
  const Vec4* velocity;
  const float* density;   ///< rho / rho_0
  float* out;             ///< output: f_T gamma_t, the temporal feature before occlusion
  float density_epsilon;  ///< share of rho_0
  float speed_epsilon;    ///< m/s
  bool dimensionless;
};

class TemporalGradients {
 public:
  /// Writes f_T gamma_t of n particles. GradientReach::TwoSupports sorts indices of the particles by cell and
  /// needs no neighbour lists; the particles' own order does not change.
  void run(GradientReach reach, const GradientFields& fields, const ParticleNeighbours& neighbours, int n,
           float finest_support);
  std::size_t bytes() const {
    return averages_.bytes() + gradients_.bytes() + keys_.bytes() + order_.bytes();
  }

 private:
  void run_smoothed(const GradientFields& fields, const ParticleNeighbours& neighbours, int n);
  void run_wide(const GradientFields& fields, int n, float finest_support);

  Array<Vec4> averages_;   // velocity and density
  Array<Vec4> gradients_;  // three per particle: (d/dx, d/dy, d/dz) of (vx, vy, vz, density)
  Sorter sorter_;
  Array<std::uint64_t> keys_;
  Array<int> order_;
};

}  // namespace sim::SIM_BACKEND
