#include "stats/image/ssim.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stats {

namespace {

constexpr int window = 2 * SsimMap::border + 1;

std::array<double, window> gaussian() {
  constexpr double sigma = 1.5;
  std::array<double, window> out{};
  double sum = 0;
  for (int k = 0; k < window; ++k) {
    const double x = k - SsimMap::border;
    sum += out[static_cast<std::size_t>(k)] = std::exp(-x * x / (2 * sigma * sigma));
  }
  for (double& weight : out) weight /= sum;
  return out;
}

std::vector<double> luma(const ImageView& image) {
  std::vector<double> out(image.pixels());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = 0.299 * image.rgb[3 * i] + 0.587 * image.rgb[3 * i + 1] + 0.114 * image.rgb[3 * i + 2];
  return out;
}

/// Sums one row of `width` values over the window; out has width - 10 values.
void filter_row(const double* in, int width, const std::array<double, window>& weights, double* out) {
  for (int x = 0; x + window <= width; ++x) {
    double sum = 0;
    for (int k = 0; k < window; ++k) sum += weights[static_cast<std::size_t>(k)] * in[x + k];
    out[x] = sum;
  }
}

/// The Gaussian mean of a(i) over each whole window, along rows and then along columns.
std::vector<double> filtered(const std::vector<double>& values, int width, int height) {
  const auto weights = gaussian();
  const int out_width = width - window + 1;
  const int out_height = height - window + 1;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(out_width) + static_cast<std::size_t>(x);
  };
  std::vector<double> rows(at(0, height));
  for (int y = 0; y < height; ++y) {
    const auto begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    filter_row(values.data() + begin, width, weights, rows.data() + at(0, y));
  }
  std::vector<double> out(at(0, out_height), 0.0);
  for (int y = 0; y < out_height; ++y) {
    for (int k = 0; k < window; ++k) {
      const double weight = weights[static_cast<std::size_t>(k)];
      for (int x = 0; x < out_width; ++x) out[at(x, y)] += weight * rows[at(x, y + k)];
    }
  }
  return out;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
  return out;
}

}  // namespace

SsimMap ssim_map(const ImageView& a, const ImageView& b) {
  check_images(a, b, {});
  if (a.width < window || a.height < window)
    throw std::invalid_argument("pictures must be at least 11 x 11 px for SSIM");
  const auto filter = [&](const std::vector<double>& values) { return filtered(values, a.width, a.height); };
  const auto x = luma(a);
  const auto y = luma(b);
  const auto mean_x = filter(x);
  const auto mean_y = filter(y);
  const auto mean_xx = filter(product(x, x));
  const auto mean_yy = filter(product(y, y));
  const auto mean_xy = filter(product(x, y));
  constexpr double c1 = (0.01 * 255) * (0.01 * 255);
  constexpr double c2 = (0.03 * 255) * (0.03 * 255);
  SsimMap out{a.width - window + 1, a.height - window + 1, std::vector<double>(mean_x.size())};
  for (std::size_t i = 0; i < out.index.size(); ++i) {
    const double mx = mean_x[i];
    const double my = mean_y[i];
    const double variance_x = mean_xx[i] - mx * mx;
    const double variance_y = mean_yy[i] - my * my;
    const double covariance = mean_xy[i] - mx * my;
    // C3 = C2 / 2 folds contrast and structure into one factor (Eq. 13).
    out.index[i] = (2 * mx * my + c1) * (2 * covariance + c2) /
                   ((mx * mx + my * my + c1) * (variance_x + variance_y + c2));
  }
  return out;
}

ImageScore SsimMap::mean(MaskView mask) const {
  const auto full_width = static_cast<std::size_t>(width + 2 * border);
  if (!mask.empty() && mask.size() != full_width * static_cast<std::size_t>(height + 2 * border))
    throw std::invalid_argument("a mask must have the picture's size");
  ImageScore out;
  double sum = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    const std::size_t x = i % static_cast<std::size_t>(width) + border;
    const std::size_t y = i / static_cast<std::size_t>(width) + border;
    if (!mask.empty() && mask[y * full_width + x] == 0) continue;
    ++out.pixels;
    sum += index[i];
  }
  out.value = out.pixels ? sum / static_cast<double>(out.pixels) : std::numeric_limits<double>::quiet_NaN();
  return out;
}

}  // namespace stats
