#include "stats/image/ssim.hpp"

#include <algorithm>
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
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = 0.299 * image.rgb[3 * i] + 0.587 * image.rgb[3 * i + 1] + 0.114 * image.rgb[3 * i + 2];
  return out;
}

/// Rows of the SSIM map that a thread computes as one block. Their windows extend over ten more rows of the
/// picture, which neighbouring blocks filter again.
constexpr int band_rows = 24;
/// The quantities that the window averages: x, y, x^2, y^2 and x y.
constexpr int quantities = 5;

/// Averages the five quantities along a row of lumas x and y with the window's weights. Quantity q of pixel i
/// goes to out[q * width + i].
void filter_row(const double* x, const double* y, int width, const std::array<double, window>& weights,
                double* out) {
  std::fill_n(out, quantities * width, 0.0);
  for (int k = 0; k < window; ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    for (int i = 0; i < width; ++i) {
      const double at_x = x[i + k];
      const double at_y = y[i + k];
      out[i] += weight * at_x;
      out[width + i] += weight * at_y;
      out[2 * width + i] += weight * (at_x * at_x);
      out[3 * width + i] += weight * (at_y * at_y);
      out[4 * width + i] += weight * (at_x * at_y);
    }
  }
}

/// Computes the SSIM indices of one row from the five averaged quantities of each pixel.
void index_row(const double* mean, int width, double* out) {
  constexpr double c1 = (0.01 * 255) * (0.01 * 255);
  constexpr double c2 = (0.03 * 255) * (0.03 * 255);
  for (int i = 0; i < width; ++i) {
    const double mx = mean[i];
    const double my = mean[width + i];
    const double variance_x = mean[2 * width + i] - mx * mx;
    const double variance_y = mean[3 * width + i] - my * my;
    const double covariance = mean[4 * width + i] - mx * my;
    // With C3 = C2 / 2, contrast and structure combine into one factor (Wang et al. 2004, Eq. 13).
    out[i] = (2 * mx * my + c1) * (2 * covariance + c2) /
             ((mx * mx + my * my + c1) * (variance_x + variance_y + c2));
  }
}

/// Fills rows [first, last) of the SSIM map. The Gaussian window is separable: it is applied along x, then
/// along y.
void fill_band(const std::vector<double>& x, const std::vector<double>& y, int first, int last,
               const std::array<double, window>& weights, SsimMap& map) {
  const int stride = quantities * map.width;
  const auto at = [](int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
  };
  std::vector<double> rows(at(last - first + window - 1, stride));
  for (int row = first; row < last + window - 1; ++row) {
    const std::size_t begin = at(row, map.width + 2 * SsimMap::border);
    filter_row(x.data() + begin, y.data() + begin, map.width, weights, rows.data() + at(row - first, stride));
  }
  std::vector<double> mean(at(1, stride));
  for (int row = first; row < last; ++row) {
    std::fill(mean.begin(), mean.end(), 0.0);
    for (int k = 0; k < window; ++k) {
      const double weight = weights[static_cast<std::size_t>(k)];
      const double* from = rows.data() + at(row - first + k, stride);
      for (int i = 0; i < stride; ++i) mean[static_cast<std::size_t>(i)] += weight * from[i];
    }
    index_row(mean.data(), map.width, map.index.data() + at(row, map.width));
  }
}

}  // namespace

SsimMap ssim_map(const ImageView& a, const ImageView& b) {
  check_images(a, b, {});
  if (a.width < window || a.height < window)
    throw std::invalid_argument(
        "ssim_map: the pictures are smaller than the window; give pictures of at least 11 x 11 px");
  const auto x = luma(a);
  const auto y = luma(b);
  const auto weights = gaussian();
  SsimMap out{a.width - window + 1, a.height - window + 1, {}};
  out.index.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  const int bands = (out.height + band_rows - 1) / band_rows;
#pragma omp parallel for schedule(static)
  for (int band = 0; band < bands; ++band) {
    const int first = band * band_rows;
    fill_band(x, y, first, std::min(first + band_rows, out.height), weights, out);
  }
  return out;
}

ImageScore SsimMap::mean(MaskView mask) const {
  const auto full_width = static_cast<std::size_t>(width + 2 * border);
  if (!mask.empty() && mask.size() != full_width * static_cast<std::size_t>(height + 2 * border))
    throw std::invalid_argument(
        "SsimMap::mean: the mask does not fit the pictures; give one byte for each of their pixels, or none");
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
