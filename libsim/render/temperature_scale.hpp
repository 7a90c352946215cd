#pragma once
/// The colour scale of temperatures over the water: one per scene, independent of the current temperatures.

#include <span>
#include <string>

#include "libsim/render/fluid_renderer.hpp"
#include "libsim/scene/scene.hpp"

namespace sim {

/// A scale from the lowest to the highest temperature in a scene with the effect heat (sim::temperatures_of).
class TemperatureScale {
 public:
  /// Do not call overlay() for a scene without heat.
  explicit TemperatureScale(const Scene& scene);

  /// True if the scene lists heat with a diffusivity above 0, so that its water has temperatures.
  bool heat() const { return heat_; }
  /// above_k: K above the scene's reference, one value per particle; must outlive the overlay.
  Overlay overlay(std::span<const float> above_k) const;
  /// "temperature 293.15 to 353.15 K".
  std::string words() const;

  /// True if both scales give every temperature the same colour.
  bool same_colours(const TemperatureScale& other) const {
    return least_k_ == other.least_k_ && most_k_ == other.most_k_;
  }

 private:
  bool heat_;
  double reference_k_ = 0, least_k_ = 0, most_k_ = 1;
};

}  // namespace sim
