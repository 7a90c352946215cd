#include <algorithm>
#include <cstdlib>

#include "libsim/bake/codec.hpp"

namespace sim {

namespace {

/// How the pixels of a row are predicted: as 0, or from pixels to the left, above, or at the same place in
/// the previous picture. Gradient: left + above - above left.
enum Predictor : std::uint8_t { None, Left, Above, Gradient, Previous, predictors };

using Row = std::uint8_t*;
using ConstRow = const std::uint8_t*;

/// Writes the planes G, R - G and B - G of an RGBA picture, one after the other.
void split_planes(ByteSpan rgba, std::size_t pixels, std::uint8_t* planes) {
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t green = rgba[4 * i + 1];
    planes[i] = green;
    planes[pixels + i] = static_cast<std::uint8_t>(rgba[4 * i] - green);
    planes[2 * pixels + i] = static_cast<std::uint8_t>(rgba[4 * i + 2] - green);
  }
}

void join_planes(const std::uint8_t* planes, std::size_t pixels, std::uint8_t* rgba) {
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t green = planes[i];
    rgba[4 * i] = static_cast<std::uint8_t>(planes[pixels + i] + green);
    rgba[4 * i + 1] = green;
    rgba[4 * i + 2] = static_cast<std::uint8_t>(planes[2 * pixels + i] + green);
    rgba[4 * i + 3] = 255;
  }
}

/// residual = row - prediction. `above`: the row above; `before`: the same row of the previous picture. A
/// null row counts as zeros.
void residual_row(Predictor predictor, ConstRow row, ConstRow above, ConstRow before, std::size_t width,
                  Row residual) {
  for (std::size_t x = 0; x < width; ++x) {
    const int left = x > 0 ? row[x - 1] : 0;
    const int up = above ? above[x] : 0;
    const int corner = above && x > 0 ? above[x - 1] : 0;
    const int old = before ? before[x] : 0;
    const int guess[predictors] = {0, left, up, left + up - corner, old};
    residual[x] = static_cast<std::uint8_t>(row[x] - guess[predictor]);
  }
}

/// Sum of the absolute residuals, read as signed bytes. A smaller sum promises a smaller compressed row.
long cost(ConstRow residual, std::size_t width) {
  long sum = 0;
  for (std::size_t x = 0; x < width; ++x) sum += std::abs(static_cast<std::int8_t>(residual[x]));
  return sum;
}

void sum_left(Row row, std::size_t width) {
  std::uint8_t sum = 0;
  for (std::size_t x = 0; x < width; ++x) row[x] = sum = static_cast<std::uint8_t>(sum + row[x]);
}

void add_row(Row row, ConstRow other, std::size_t width) {
  for (std::size_t x = 0; x < width; ++x) row[x] = static_cast<std::uint8_t>(row[x] + other[x]);
}

/// Converts a row of residuals back into the row.
void restore_row(Predictor predictor, Row row, ConstRow above, ConstRow before, std::size_t width) {
  if (predictor == Left || predictor == Gradient) sum_left(row, width);
  if ((predictor == Above || predictor == Gradient) && above) add_row(row, above, width);
  if (predictor == Previous && before) add_row(row, before, width);
}

}  // namespace

void encode_picture(const BakeFacts& facts, ByteSpan rgba, ByteSpan previous, int width_px, int height_px,
                    int zstd_level, Bytes& out) {
  const auto width = static_cast<std::size_t>(width_px);
  const auto rows = 3 * static_cast<std::size_t>(height_px);
  const std::size_t pixels = width * static_cast<std::size_t>(height_px);
  Bytes planes(3 * pixels), old_planes(previous.empty() ? 0 : 3 * pixels);
  split_planes(rgba, pixels, planes.data());
  if (!previous.empty()) split_planes(previous, pixels, old_planes.data());

  // The data are the predictors of all rows, then all residuals: similar bytes are adjacent and compress
  // better.
  Bytes data(rows + 3 * pixels), trial(width);
  for (std::size_t y = 0; y < rows; ++y) {
    ConstRow row = planes.data() + y * width;
    ConstRow above = y % static_cast<std::size_t>(height_px) ? row - width : nullptr;
    ConstRow before = previous.empty() ? nullptr : old_planes.data() + y * width;
    long best = -1;
    for (int p = None; p < (before ? predictors : Previous); ++p) {
      residual_row(static_cast<Predictor>(p), row, above, before, width, trial.data());
      const long price = cost(trial.data(), width);
      if (best >= 0 && price >= best) continue;
      best = price;
      data[y] = static_cast<std::uint8_t>(p);
      std::copy(trial.begin(), trial.end(), data.begin() + static_cast<std::ptrdiff_t>(rows + y * width));
    }
  }
  out.clear();
  ByteWriter writer(out);
  put_facts(writer, facts);
  pack(data, zstd_level, out);
}

void decode_picture(ByteSpan payload, std::uint32_t format, std::size_t levels, ByteSpan previous,
                    int width_px, int height_px, const std::string& place, Bytes& scratch, BakePicture& out) {
  const auto width = static_cast<std::size_t>(width_px);
  const auto rows = 3 * static_cast<std::size_t>(height_px);
  const std::size_t pixels = width * static_cast<std::size_t>(height_px);
  ByteReader in(payload, place);
  out.facts = get_facts(in, format, levels);
  unpack(in, rows + 3 * pixels, scratch);

  thread_local Bytes old_planes;
  old_planes.resize(previous.empty() ? 0 : 3 * pixels);
  if (!previous.empty()) split_planes(previous, pixels, old_planes.data());
  Row planes = scratch.data() + rows;
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t predictor = scratch[y];
    if (predictor >= predictors || (predictor == Previous && previous.empty())) {
      in.fail("states predictor " + std::to_string(predictor) + " for row " + std::to_string(y) +
              ", which is unknown or needs an earlier picture");
    }
    Row row = planes + y * width;
    restore_row(static_cast<Predictor>(predictor), row,
                y % static_cast<std::size_t>(height_px) ? row - width : nullptr,
                previous.empty() ? nullptr : old_planes.data() + y * width, width);
  }
  out.rgba.resize(4 * pixels);
  join_planes(planes, pixels, out.rgba.data());
}

}  // namespace sim
