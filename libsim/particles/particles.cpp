#include "libsim/particles/particles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
  constexpr std::array names{
#define SIM_NAME(Name, member, ...) #member,
      SIM_COLUMNS(SIM_NAME, SIM_NAME)
#undef SIM_NAME
  };
  static_assert(names.size() == static_cast<std::size_t>(Column::count));
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
#define SIM_VISIT(Name, member, Type, life) visit(self.columns_.member, self.has(Column::Name), Life::life);
#define SIM_NOTHING(...)
  SIM_COLUMNS(SIM_VISIT, SIM_NOTHING)
#undef SIM_VISIT
#undef SIM_NOTHING
}

template <class T>
void Particles::reorder_extras(const Array<int>& order, std::vector<Array<T>>& spares) {
  GatherExtras<T> gather{order.data(), {}, {}, 0};
  std::vector<Array<T>*> moved;
  for_each_column(*this, [&](auto& column, bool declared, Life life) {
    if constexpr (std::is_same_v<decltype(column), Array<T>&>) {
      if (declared && life == Life::Kept) moved.push_back(&column);
    }
  });
  spares.resize(std::max(spares.size(), moved.size()));
  for (std::size_t k = 0; k < moved.size(); ++k) {
    Array<T>& spare = spares[k];
    spare.reserve(static_cast<std::size_t>(capacity_));
    spare.resize(order.size());
    gather.in[k] = moved[k]->data();
    gather.out[k] = spare.data();
  }
  gather.count = static_cast<int>(moved.size());
  if (gather.count == 0) return;
  for_each("reorder", static_cast<int>(order.size()), gather);
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k]->swap(spares[k]);
}

void Particles::allocate(ColumnSet set, int n, int capacity) {
  set_ = set;
  capacity_ = std::max(n, capacity);
  for_each_column(*this, [&](auto& column, bool wanted, Life) {
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
  for_each_column(*this, [&](auto& column, bool wanted, Life) {
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
  for_each_column(*this, [&](const auto& column, bool, Life) { sum += column.bytes(); });
  return sum;
}

void Particles::reorder(const Array<int>& order) {
  const int n = static_cast<int>(order.size());
  const auto room = [&](auto& spare) {
    spare.reserve(static_cast<std::size_t>(capacity_));
    spare.resize(order.size());
    return spare.data();
  };
  auto& c = columns_;
  for_each("reorder", n,
           Gather{.order = order.data(),
                  .position_in = c.position.data(),
                  .predicted_in = c.predicted.data(),
                  .velocity_in = c.velocity.data(),
                  .id_in = c.id.data(),
                  .level_in = c.level.data(),
                  .position = room(spare_a_),
                  .predicted = room(spare_b_),
                  .velocity = room(spare_c_),
                  .id = room(spare_id_),
                  .level = room(spare_level_)});
  c.position.swap(spare_a_);
  c.predicted.swap(spare_b_);
  c.velocity.swap(spare_c_);
  c.id.swap(spare_id_);
  c.level.swap(spare_level_);
  reorder_extras(order, spare_bytes_);
  reorder_extras(order, spare_floats_);
  reorder_extras(order, spare_ints_);
  reorder_extras(order, spare_parts_);
  if (n != n_) resize(n);
}

}  // namespace sim::SIM_BACKEND
