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

/// Parses one of the names "none", "acuity", "manifold", "temporal", "combined", "saliency", "level",
/// "speed", "density", "active" and "temperature". base::Error for other names.
OverlayKind parse_overlay(std::string_view name);
/// Parses one or more names, separated by commas.
std::vector<OverlayKind> parse_overlays(std::string_view names);
/// Names of the overlays in the order of OverlayKind.
const std::vector<std::string>& overlay_names();
/// Names of the overlays with the paper's symbols, such as "acuity f_a".
const std::vector<std::string>& overlay_titles();

/// Reads values of the particles of a simulation and paints them over the last picture of the water.
class OverlayPainter {
 public:
  /// scene: determines the temperatures at the ends of the colour scale. finest_spacing_m: rest spacing of
  /// the finest particles.
  OverlayPainter(const sim::Scene& scene, double finest_spacing_m)
      : finest_spacing_m_(finest_spacing_m), temperatures_(scene) {}
  void paint(OverlayKind kind, sim::Simulation& fluid, sim::FluidPicture& picture, unsigned framebuffer);
  /// Meaning of the last paint's colours, e.g. "speed 0 to 15 m/s".
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
