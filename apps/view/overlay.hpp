#pragma once
/// Values of the particles that vip-view can paint over the water.

#include <string>
#include <string_view>
#include <vector>

#include "libsim/render/fluid_picture.hpp"
#include "libsim/render/temperature_scale.hpp"

namespace apps {

enum class OverlayKind {
  None,
  Acuity,
  Manifold,
  Temporal,
  Combined,
  Saliency,
  Level,
  Speed,
  Density,
  Active,
  Temperature
};

/// "none", "acuity", "manifold", "temporal", "combined", "saliency", "level", "speed", "density", "active",
/// "temperature"; others are a base::Error.
OverlayKind parse_overlay(std::string_view name);
/// Several, separated by commas; at least one.
std::vector<OverlayKind> parse_overlays(std::string_view names);
/// In the order of the enum.
const std::vector<std::string>& overlay_names();
/// The same with the paper's symbols: "acuity f_a".
const std::vector<std::string>& overlay_titles();

/// Reads values of a simulation and paints them over the picture of it that was just drawn.
class OverlayPainter {
 public:
  /// `finest_spacing_m` is 2 r_*. The scene gives the range of temperatures.
  OverlayPainter(const sim::Scene& scene, double finest_spacing_m)
      : finest_spacing_m_(finest_spacing_m), temperatures_(scene) {}
  void paint(OverlayKind kind, sim::Simulation& fluid, sim::FluidPicture& picture, unsigned framebuffer);
  /// Meaning of the last paint's colours, e.g. "speed 0 to 10 m/s".
  const std::string& legend() const { return legend_; }

 private:
  bool take_saliency(OverlayKind kind, const sim::Simulation& fluid);

  double finest_spacing_m_;
  sim::TemperatureScale temperatures_;
  std::vector<float> values_;
  std::vector<sim::ParticleSaliency> saliency_;
  std::vector<sim::RenderParticle> particles_;
  std::string legend_;
};

}  // namespace apps
