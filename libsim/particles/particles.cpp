#include "libsim/particles/particles.hpp"

#include <algorithm>
#include <type_traits>

namespace sim::SIM_BACKEND {

namespace {

struct Gather {
  const int* order;
  const Vec4* position_in;
  const Vec4* predicted_in;
  const Vec4* velocity_in;
  const int* id_in;
  const std::uint8_t* level_in;
  Vec4* position;
  Vec4* predicted;
  Vec4* velocity;
  int* id;
  std::uint8_t* level;
  SIM_FN void operator()(int i) const {
    const int from = order[i];
    position[i] = position_in[from];
    predicted[i] = predicted_in[from];
    velocity[i] = velocity_in[from];
    id[i] = id_in[from];
    level[i] = level_in[from];
  }
};

/// The columns of one type that a method has besides, all in one launch.
template <class T>
struct GatherExtras {
  static constexpr int most = 8;
  const int* order;
  const T* in[most];
  T* out[most];
  int count;
  SIM_FN void operator()(int i) const {
    const int from = order[i];
    for (int k = 0; k < count; ++k) out[k][i] = in[k][from];
  }
};

}  // namespace

const char* column_name(Column column) {
  constexpr std::array<const char*, static_cast<std::size_t>(Column::count)> names{
      "position",       "velocity", "id",         "level",  "predicted", "predicted_next", "velocity_next",
      "lambda",         "density",  "neighbours", "target", "history",   "saliency",       "unrest",
      "saliency_parts", "waiting",  "ease",       "age",    "active",    "rest",           "start_cell"};
  return names[static_cast<std::size_t>(column)];
}

LevelSupports level_supports(double finest_support) {
  LevelSupports out{};
  for (int level = 0; level < LevelSupports::most; ++level) {
    out.h[level] = static_cast<float>(std::cbrt(1 << level) * finest_support);
  }
  return out;
}

template <class Self, class Visit>
void Particles::for_each_column(Self& self, Visit visit) {
  visit(self.position, self.has(Column::Position));
  visit(self.velocity, self.has(Column::Velocity));
  visit(self.id, self.has(Column::Id));
  visit(self.level, self.has(Column::Level));
  visit(self.predicted, self.has(Column::Predicted));
  visit(self.predicted_next, self.has(Column::PredictedNext));
  visit(self.velocity_next, self.has(Column::VelocityNext));
  visit(self.lambda, self.has(Column::Lambda));
  visit(self.density, self.has(Column::Density));
  visit(self.target, self.has(Column::Target));
  visit(self.history, self.has(Column::History));
  visit(self.saliency, self.has(Column::Saliency));
  visit(self.unrest, self.has(Column::Unrest));
  visit(self.saliency_parts, self.has(Column::SaliencyParts));
  visit(self.waiting, self.has(Column::Waiting));
  visit(self.ease, self.has(Column::Ease));
  visit(self.age, self.has(Column::Age));
  visit(self.active, self.has(Column::Active));
  visit(self.rest, self.has(Column::Rest));
  visit(self.start_cell, self.has(Column::StartCell));
}

template <class T>
void Particles::reorder_extras(const Array<int>& order,
                               std::initializer_list<std::pair<Column, Array<T>*>> extras,
                               std::vector<Array<T>>& spares) {
  GatherExtras<T> gather{order.data(), {}, {}, 0};
  spares.resize(extras.size());
  for (const auto& [column, values] : extras) {
    if (!has(column)) continue;
    Array<T>& spare = spares[static_cast<std::size_t>(gather.count)];
    spare.reserve(static_cast<std::size_t>(capacity_));
    spare.resize(order.size());
    gather.in[gather.count] = values->data();
    gather.out[gather.count] = spare.data();
    ++gather.count;
  }
  if (gather.count == 0) return;
  for_each("reorder", static_cast<int>(order.size()), gather);
  auto spare = spares.begin();
  for (const auto& [column, values] : extras) {
    if (has(column)) values->swap(*spare++);
  }
}

void Particles::allocate(ColumnSet set, int n, int capacity) {
  set_ = set;
  capacity_ = std::max(n, capacity);
  for_each_column(*this, [&](auto& column, bool wanted) {
    if (wanted) {
      column.reserve(static_cast<std::size_t>(capacity_));
    } else {
      column = std::remove_reference_t<decltype(column)>();
    }
  });
  resize(n);
}

void Particles::resize(int n) {
  n_ = n;
  for_each_column(*this, [&](auto& column, bool wanted) {
    if (wanted) column.resize(static_cast<std::size_t>(n));
  });
}

std::size_t Particles::bytes() const {
  std::size_t sum =
      spare_a_.bytes() + spare_b_.bytes() + spare_c_.bytes() + spare_id_.bytes() + spare_level_.bytes();
  const auto add = [&](const auto& spares) {
    for (const auto& spare : spares) sum += spare.bytes();
  };
  add(spare_bytes_);
  add(spare_floats_);
  add(spare_ints_);
  add(spare_parts_);
  for_each_column(*this, [&](const auto& column, bool) { sum += column.bytes(); });
  return sum;
}

void Particles::reorder(const Array<int>& order) {
  const int n = static_cast<int>(order.size());
  const auto room = [&](auto& spare) {
    spare.reserve(static_cast<std::size_t>(capacity_));
    spare.resize(order.size());
    return spare.data();
  };
  for_each("reorder", n,
           Gather{order.data(), position.data(), predicted.data(), velocity.data(), id.data(), level.data(),
                  room(spare_a_), room(spare_b_), room(spare_c_), room(spare_id_), room(spare_level_)});
  position.swap(spare_a_);
  predicted.swap(spare_b_);
  velocity.swap(spare_c_);
  id.swap(spare_id_);
  level.swap(spare_level_);
  reorder_extras<std::uint8_t>(order,
                               {{Column::Target, &target},
                                {Column::History, &history},
                                {Column::Waiting, &waiting},
                                {Column::Age, &age},
                                {Column::Active, &active},
                                {Column::Rest, &rest}},
                               spare_bytes_);
  reorder_extras<float>(order, {{Column::Saliency, &saliency}, {Column::Unrest, &unrest}}, spare_floats_);
  reorder_extras<int>(order, {{Column::StartCell, &start_cell}}, spare_ints_);
  reorder_extras<SaliencyParts>(order, {{Column::SaliencyParts, &saliency_parts}}, spare_parts_);
  if (n != n_) resize(n);
}

}  // namespace sim::SIM_BACKEND
