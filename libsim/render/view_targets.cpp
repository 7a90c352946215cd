#include "libsim/render/view_targets.hpp"

namespace sim {

void ViewTargets::resize(const View& new_view, int thickness_step) {
  view = new_view;
  width = view.viewport.width;
  height = view.viewport.height;
  cells_x = (width + thickness_step - 1) / thickness_step;
  cells_y = (height + thickness_step - 1) / thickness_step;
  const std::int64_t pixels = std::int64_t{width} * height;
  const std::int64_t cells = std::int64_t{cells_x} * cells_y;
  block.reserve(512);
  for (GlBuffer* buffer : {&depth, &front, &filter_a, &filter_b}) buffer->reserve(4 * pixels);
  normals.reserve(16 * pixels);
  blocks.reserve(4 * std::int64_t{(width + 15) / 16} * ((height + 15) / 16));
  for (GlBuffer* buffer : {&thickness, &thickness_a, &thickness_b}) buffer->reserve(4 * cells);
}

void ViewTargets::follow(std::int64_t count) {
  if (count == followed_) return;
  touched.reserve(4 * count);
  touched.fill(0);
  followed_ = count;
}

}  // namespace sim
