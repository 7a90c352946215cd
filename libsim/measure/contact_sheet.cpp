#include "libsim/measure/contact_sheet.hpp"

#include <algorithm>

namespace measure {

namespace {

void paste(const sim::Image& from, sim::Image& to, int left, int top) {
  const auto row_bytes = static_cast<std::size_t>(4 * from.width);
  for (int y = 0; y < from.height; ++y) {
    const auto source = static_cast<std::size_t>(y) * row_bytes;
    const auto target = 4 * (static_cast<std::size_t>(top + y) * static_cast<std::size_t>(to.width) +
                             static_cast<std::size_t>(left));
    std::copy_n(from.rgba.begin() + static_cast<std::ptrdiff_t>(source), row_bytes,
                to.rgba.begin() + static_cast<std::ptrdiff_t>(target));
  }
}

}  // namespace

sim::Image contact_sheet(const std::vector<SheetColumn>& columns) {
  sim::Image out;
  if (columns.empty()) return out;
  const int width = columns.front().picture.width;
  const int height = columns.front().picture.height;
  out.width = width * static_cast<int>(columns.size());
  out.height = 2 * height;
  out.rgba.resize(4 * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  int left = 0;
  for (const auto& column : columns) {
    paste(column.picture, out, left, 0);
    paste(column.levels, out, left, height);
    left += width;
  }
  return out;
}

void SheetWriter::write(std::filesystem::path path, sim::Image image) {
  pending_.push_back(std::async(
      std::launch::async, [path = std::move(path), image = std::move(image)] { write_png(path, image); }));
}

void SheetWriter::finish() {
  auto pending = std::move(pending_);
  pending_.clear();
  for (auto& each : pending) each.get();
}

}  // namespace measure
