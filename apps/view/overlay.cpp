#include "apps/view/overlay.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

constexpr float fastest_m_s = 15;
constexpr float densest_error = 0.05F;

}  // namespace

const std::vector<std::string>& overlay_names() {
  static const std::vector<std::string> names{"none",     "acuity",   "manifold",   "temporal",
                                              "combined", "saliency", "level",      "speed",
                                              "density",  "active",   "temperature"};
  return names;
}

const std::vector<std::string>& overlay_titles() {
  static const std::vector<std::string> titles{"none",       "acuity f_a", "manifold f_m", "temporal f_T",
                                               "combined F", "saliency s", "level",        "speed",
                                               "density",    "active",     "temperature"};
  return titles;
}

OverlayKind parse_overlay(std::string_view name) {
  const auto& names = overlay_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<OverlayKind>(found - names.begin());
  throw base::Error("--overlay " + std::string(name), "is not known", "use one of " + base::joined(names));
}

std::vector<OverlayKind> parse_overlays(std::string_view names) {
  std::vector<OverlayKind> out;
  for (std::size_t comma = 0; comma != std::string_view::npos; names.remove_prefix(comma + 1)) {
    comma = names.find(',');
    out.push_back(parse_overlay(names.substr(0, comma)));
    if (comma == std::string_view::npos) break;
  }
  return out;
}

bool OverlayPainter::take_saliency(OverlayKind kind, const sim::Simulation& fluid) {
  fluid.read_saliency(saliency_);
  values_.clear();
  for (const auto& p : saliency_) {
    switch (kind) {
      case OverlayKind::Acuity:
        values_.push_back(p.acuity);
        break;
      case OverlayKind::Manifold:
        values_.push_back(p.manifold);
        break;
      case OverlayKind::Temporal:
        values_.push_back(p.temporal);
        break;
      case OverlayKind::Combined:
        values_.push_back(p.combined);
        break;
      default:
        values_.push_back(p.s);
    }
  }
  return !values_.empty();
}

void OverlayPainter::paint(OverlayKind kind, sim::Simulation& fluid, sim::FluidPicture& picture,
                           unsigned framebuffer) {
  sim::Overlay overlay;
  legend_.clear();
  const auto field = [&](sim::ParticleField which) { fluid.read_field(which, values_); };
  const std::string name = overlay_titles()[static_cast<std::size_t>(kind)];
  switch (kind) {
    case OverlayKind::None:
      return;
    case OverlayKind::Level:
      fluid.read_particles(particles_);
      values_.clear();
      for (const auto& p : particles_) {
        values_.push_back(std::round(3 * std::log2(2 * p.radius_m / static_cast<float>(finest_spacing_m_))));
      }
      overlay.classes = true;
      legend_ = "level: orange 0 (finest), green 1, blue 2, pink 3";
      break;
    case OverlayKind::Speed:
      field(sim::ParticleField::Speed);
      overlay.high = fastest_m_s;
      legend_ = fmt::format("speed 0 to {:.3g} m/s", fastest_m_s);
      break;
    case OverlayKind::Density:
      field(sim::ParticleField::DensityError);
      overlay.low = -densest_error;
      overlay.high = densest_error;
      legend_ = fmt::format("rho / rho_0 - 1: {:.3g} to {:.3g} %", -100 * densest_error, 100 * densest_error);
      break;
    case OverlayKind::Active:
      field(sim::ParticleField::Active);
      overlay.classes = true;
      legend_ = "orange: moved by the velocity grid, green: solved";
      break;
    case OverlayKind::Temperature:
      if (!temperatures_.heat()) {
        legend_ = "temperature: heat is not listed, or off, or idle";
        return;
      }
      field(sim::ParticleField::Temperature);
      overlay = temperatures_.overlay(values_);
      legend_ = temperatures_.words();
      break;
    default:
      if (!take_saliency(kind, fluid)) {
        legend_ = name + ": this method computes none, or no frame has run";
        return;
      }
      if (kind != OverlayKind::Saliency && kind != OverlayKind::Acuity) {
        overlay.high = std::max(1e-6F, *std::max_element(values_.begin(), values_.end()));
      }
      legend_ = fmt::format("{} 0 to {:.3g}", name, overlay.high);
  }
  overlay.values = values_;
  picture.renderer().paint(overlay, framebuffer);
}

}  // namespace apps
