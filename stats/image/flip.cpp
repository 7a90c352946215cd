#include "stats/image/flip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace stats {

namespace {

constexpr double most_pixels_per_degree = 200;
// Constants of FLIP: section 4.3 and Table 1 of Andersson et al. 2020 (flip.hpp).
constexpr double colour_power = 0.7, knee_share = 0.4, knee_error = 0.95;
constexpr double feature_power = 0.5, feature_width_deg = 0.082;
/// CIE XYZ of the reference white D65: the sum of each row of the matrix in relative_xyz.
constexpr std::array<double, 3> white{0.950428545, 1.0, 1.088900371};

using Colour = std::array<double, 3>;

/// One number per pixel.
struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;
  double& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  double clamped(int x, int y) const {
    x = std::clamp(x, 0, width - 1);
    y = std::clamp(y, 0, height - 1);
    return values[static_cast<std::size_t>(y) * width + x];
  }
};

Plane plane_like(const ImageView& image) {
  return {image.width, image.height, std::vector<double>(image.pixels())};
}

/// Weights of a square window with sides of 2 radius + 1 px.
struct Kernel {
  int radius = 0;
  std::vector<double> weights;
};

template <class Weight>
Kernel make_kernel(int radius, const Weight& weight) {
  Kernel out{radius, {}};
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) out.weights.push_back(weight(x, y));
  return out;
}

/// Scales positive weights to sum to 1, and negative ones, if any, to -1.
Kernel balanced(Kernel kernel) {
  double above = 0, below = 0;
  for (const double weight : kernel.weights) (weight > 0 ? above : below) += weight;
  for (double& weight : kernel.weights)
    if (weight != 0) weight /= weight > 0 ? above : -below;
  return kernel;
}

Plane filtered(const Plane& in, const Kernel& kernel) {
  Plane out{in.width, in.height, std::vector<double>(in.values.size())};
#pragma omp parallel for schedule(static)
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      const double* weight = kernel.weights.data();
      double sum = 0;
      for (int v = -kernel.radius; v <= kernel.radius; ++v)
        for (int u = -kernel.radius; u <= kernel.radius; ++u) sum += *weight++ * in.clamped(x + u, y + v);
      out.at(x, y) = sum;
    }
  }
  return out;
}

double linear(std::uint8_t encoded) {
  const double c = encoded / 255.0;
  return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
}

/// CIE XYZ of linear sRGB, each divided by the white's XYZ.
Colour relative_xyz(const Colour& rgb) {
  return {(10135552 * rgb[0] + 8788810 * rgb[1] + 4435075 * rgb[2]) / 24577794 / white[0],
          (2613072 * rgb[0] + 8788810 * rgb[1] + 887015 * rgb[2]) / 12288897 / white[1],
          (1425312 * rgb[0] + 8788810 * rgb[1] + 70074185 * rgb[2]) / 73733382 / white[2]};
}

Colour linear_rgb(const Colour& relative) {
  const double x = relative[0] * white[0], y = relative[1] * white[1], z = relative[2] * white[2];
  return {3.241003275 * x - 1.537398934 * y - 0.498615861 * z,
          -0.969224334 * x + 1.875930071 * y + 0.041554224 * z,
          0.055639423 * x - 0.204011202 * y + 1.057148933 * z};
}

/// Lightness and two opponent-colour channels of three values that are 1 for white. The values of
/// relative_xyz give YCxCz; their cube roots give L*a*b*.
Colour opponent(const Colour& c) { return {116 * c[1] - 16, 500 * (c[0] - c[1]), 200 * (c[1] - c[2])}; }
Colour from_opponent(const Colour& c) {
  const double y = (c[0] + 16) / 116;
  return {y + c[1] / 500, y, y - c[2] / 200};
}

/// L*a*b* of linear sRGB with the Hunt adjustment: a* and b* are scaled by L* / 100, since dark colours look
/// less colourful.
Colour hunt_lab(const Colour& rgb) {
  constexpr double delta = 6.0 / 29;
  Colour c = relative_xyz(rgb);
  for (double& value : c)
    value = value > delta * delta * delta ? std::cbrt(value) : value / (3 * delta * delta) + 4.0 / 29;
  Colour out = opponent(c);
  out[1] *= 0.01 * out[0];
  out[2] *= 0.01 * out[0];
  return out;
}

double hyab(const Colour& a, const Colour& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// Contrast-sensitivity filter of one channel: the sum of two Gaussians of the distance x in degrees of
/// visual angle, each a sqrt(pi / b) exp(-pi^2 x^2 / b).
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> sensitivities{
    {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

Kernel sensitivity_kernel(const Sensitivity& s, double pixels_per_degree) {
  using std::numbers::pi;
  constexpr double widest = 0.04;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixels_per_degree));
  auto out = make_kernel(radius, [&](int x, int y) {
    const double z = (x * x + y * y) / (pixels_per_degree * pixels_per_degree);
    return s.a1 * std::sqrt(pi / s.b1) * std::exp(-pi * pi * z / s.b1) +
           s.a2 * std::sqrt(pi / s.b2) * std::exp(-pi * pi * z / s.b2);
  });
  return balanced(std::move(out));
}

/// Magnitude, at each pixel, of the derivatives of the Gaussian-filtered lightness: first derivatives (order
/// 1) show edges, second ones (order 2) show points.
Plane gradient(const Plane& lightness, double pixels_per_degree, int order) {
  const double sd = 0.5 * feature_width_deg * pixels_per_degree;
  const auto weight = [&](int along, int across) {
    const double g = std::exp(-(along * along + across * across) / (2 * sd * sd));
    return order == 1 ? -along * g : (along * along / (sd * sd) - 1) * g;
  };
  const int radius = static_cast<int>(std::ceil(3 * sd));
  const Plane dx = filtered(lightness, balanced(make_kernel(radius, weight)));
  Plane out = filtered(lightness, balanced(make_kernel(radius, [&](int x, int y) { return weight(y, x); })));
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = std::hypot(dx.values[i], out.values[i]);
  return out;
}

/// A picture as the eye resolves it: colours filtered with the contrast sensitivity, and the strengths of
/// edges and points.
struct SeenPicture {
  std::vector<Colour> colours;  ///< filtered; as returned by hunt_lab()
  Plane edges, points;
};

SeenPicture seen(const ImageView& image, double pixels_per_degree) {
  std::array<Plane, 3> planes{plane_like(image), plane_like(image), plane_like(image)};
  Plane lightness = plane_like(image);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const std::uint8_t* rgb = &image.rgb[3 * i];
    const Colour c = opponent(relative_xyz({linear(rgb[0]), linear(rgb[1]), linear(rgb[2])}));
    for (std::size_t k = 0; k < 3; ++k) planes[k].values[i] = c[k];
    lightness.values[i] = (c[0] + 16) / 116;
  }
  SeenPicture out{std::vector<Colour>(image.pixels()), gradient(lightness, pixels_per_degree, 1),
                  gradient(lightness, pixels_per_degree, 2)};
  for (std::size_t k = 0; k < 3; ++k)
    planes[k] = filtered(planes[k], sensitivity_kernel(sensitivities[k], pixels_per_degree));
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    Colour rgb = linear_rgb(from_opponent({planes[0].values[i], planes[1].values[i], planes[2].values[i]}));
    for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
    out.colours[i] = hunt_lab(rgb);
  }
  return out;
}

/// Maps a HyAB distance of two colours to an error from 0 to 1. Large distances are compressed.
double colour_error(double distance) {
  static const double most = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), colour_power);
  const double error = std::pow(distance, colour_power), knee = knee_share * most;
  return error < knee ? knee_error * error / knee
                      : knee_error + (error - knee) / (most - knee) * (1 - knee_error);
}

}  // namespace

ImageScore flip(const ImageView& a, const ImageView& b, double pixels_per_degree, MaskView mask) {
  check_images(a, b, mask);
  if (!(pixels_per_degree > 0 && pixels_per_degree <= most_pixels_per_degree))
    throw std::invalid_argument(
        "flip: pixels_per_degree is out of range; give a value above 0 and at most 200");
  const SeenPicture first = seen(a, pixels_per_degree), second = seen(b, pixels_per_degree);
  double sum = 0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    ++pixels;
    const double colour = colour_error(hyab(first.colours[i], second.colours[i]));
    const double feature = std::max(std::abs(first.edges.values[i] - second.edges.values[i]),
                                    std::abs(first.points.values[i] - second.points.values[i]));
    const double seen_feature = std::pow(feature / std::numbers::sqrt2, feature_power);
    sum += std::pow(colour, 1 - std::min(seen_feature, 1.0));
  }
  return {pixels ? sum / static_cast<double>(pixels) : std::numeric_limits<double>::quiet_NaN(), pixels};
}

}  // namespace stats
