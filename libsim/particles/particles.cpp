#include "libsim/particles/particles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace sim::SIM_BACKEND {

namespace {

/// The columns of one type whose values last as long as the particle (Life::Kept), with source and
/// destination of a reordering.
template <class T>
struct Extras {
  static constexpr int most = 8;
  static_assert(kept_count<T>() <= most);
  const T* in[most];
  T* out[most];
  int count;
  SIM_FN void gather(int i, int from) const {
    for (int k = 0; k < count; ++k) out[k][i] = in[k][from];
  }
};

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
  Extras<std::uint8_t> bytes;
  Extras<float> floats;
  Extras<int> ints;
  Extras<Vec4> vectors;
  Extras<SaliencyParts> parts;
  SIM_FN void operator()(int i) const {
    const int from = order[i];
    position[i] = position_in[from];
    predicted[i] = predicted_in[from];
    velocity[i] = velocity_in[from];
    id[i] = id_in[from];
    level[i] = level_in[from];
    bytes.gather(i, from);
    floats.gather(i, from);
    ints.gather(i, from);
    vectors.gather(i, from);
    parts.gather(i, from);
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
#define SIM_VISIT(Name, member, Type, life, rule) \
  visit(self.columns_.member, self.has(Column::Name), Life::life, Descent::rule);
#define SIM_NOTHING(...)
  SIM_COLUMNS(SIM_VISIT, SIM_NOTHING)
#undef SIM_VISIT
#undef SIM_NOTHING
}

template <class T>
std::vector<Array<T>*> Particles::kept_columns() {
  std::vector<Array<T>*> out;
  for_each_column(*this, [&](auto& column, bool declared, Life life, Descent) {
    if constexpr (std::is_same_v<decltype(column), Array<T>&>) {
      if (declared && life == Life::Kept) out.push_back(&column);
    }
  });
  return out;
}

Descents Particles::descents() {
  Descents out{};
  const auto add = [](auto& ruled, auto& column, Descent rule) {
    ruled.values[ruled.count] = column.data();
    ruled.rule[ruled.count++] = rule;
  };
  for_each_column(*this, [&](auto& column, bool declared, Life, Descent rule) {
    if (!declared || !by_rule(rule)) return;
    if constexpr (std::is_same_v<decltype(column), Array<float>&>) add(out.floats, column, rule);
    if constexpr (std::is_same_v<decltype(column), Array<std::uint8_t>&>) add(out.bytes, column, rule);
  });
  return out;
}

void Particles::begin_descents() {
  for_each_column(*this, [](auto& column, bool declared, Life, Descent rule) {
    if (declared && by_rule(rule)) column.zero();
  });
}

void Particles::allocate(ColumnSet set, int n, int capacity) {
  set_ = set;
  capacity_ = std::max(n, capacity);
  for_each_column(*this, [&](auto& column, bool wanted, Life, Descent) {
    if (wanted) {
      column.reserve(static_cast<std::size_t>(capacity_));
    } else {
      column = std::remove_reference_t<decltype(column)>();
    }
  });
  resize(n);
}

void Particles::change_columns(ColumnSet set) {
  set_ = set;
  for_each_column(*this, [&](auto& column, bool wanted, Life, Descent rule) {
    if (!wanted) {
      column = std::remove_reference_t<decltype(column)>();
    } else if (column.bytes() == 0) {
      column.reserve(static_cast<std::size_t>(capacity_));
      column.resize(static_cast<std::size_t>(n_));
      if (by_rule(rule)) column.zero();
    }
  });
}

void Particles::resize(int n) {
  n_ = n;
  for_each_column(*this, [&](auto& column, bool wanted, Life, Descent) {
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
  add(spare_vectors_);
  add(spare_parts_);
  for_each_column(*this, [&](const auto& column, bool, Life, Descent) { sum += column.bytes(); });
  return sum;
}

void Particles::reorder(const Array<int>& order) {
  const int n = static_cast<int>(order.size());
  const auto room = [&](auto& spare) {
    spare.reserve(static_cast<std::size_t>(capacity_));
    spare.resize(order.size());
    return spare.data();
  };
  const auto extras = [&]<class T>(const std::vector<Array<T>*>& kept, std::vector<Array<T>>& spares) {
    Extras<T> out{{}, {}, static_cast<int>(kept.size())};
    spares.resize(kept.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      out.in[k] = kept[k]->data();
      out.out[k] = room(spares[k]);
    }
    return out;
  };
  const auto swap_extras = [](const auto& kept, auto& spares) {
    for (std::size_t k = 0; k < kept.size(); ++k) kept[k]->swap(spares[k]);
  };
  const auto bytes = kept_columns<std::uint8_t>();
  const auto floats = kept_columns<float>();
  const auto ints = kept_columns<int>();
  const auto vectors = kept_columns<Vec4>();
  const auto parts = kept_columns<SaliencyParts>();
  auto& c = columns_;
  // PredictedNext and VelocityNext serve as destinations, because no pass reads their values after a
  // reordering.
  auto& predicted_to = has(Column::PredictedNext) ? c.predicted_next : spare_b_;
  auto& velocity_to = has(Column::VelocityNext) ? c.velocity_next : spare_c_;
  for_each("reorder", n,
           Gather{.order = order.data(),
                  .position_in = c.position.data(),
                  .predicted_in = c.predicted.data(),
                  .velocity_in = c.velocity.data(),
                  .id_in = c.id.data(),
                  .level_in = c.level.data(),
                  .position = room(spare_a_),
                  .predicted = room(predicted_to),
                  .velocity = room(velocity_to),
                  .id = room(spare_id_),
                  .level = room(spare_level_),
                  .bytes = extras(bytes, spare_bytes_),
                  .floats = extras(floats, spare_floats_),
                  .ints = extras(ints, spare_ints_),
                  .vectors = extras(vectors, spare_vectors_),
                  .parts = extras(parts, spare_parts_)});
  c.position.swap(spare_a_);
  c.predicted.swap(predicted_to);
  c.velocity.swap(velocity_to);
  c.id.swap(spare_id_);
  c.level.swap(spare_level_);
  swap_extras(bytes, spare_bytes_);
  swap_extras(floats, spare_floats_);
  swap_extras(ints, spare_ints_);
  swap_extras(vectors, spare_vectors_);
  swap_extras(parts, spare_parts_);
  if (n != n_) resize(n);
}

namespace {

struct MarkFree {
  int* free;
  SIM_FN void operator()(int id) const { free[id] = 1; }
};

struct MarkTaken {
  const int* id;
  const std::uint8_t* gone;
  int* free;
  int capacity;
  SIM_FN void operator()(int i) const {
    if (gone && gone[i]) return;
    if (id[i] >= 0 && id[i] < capacity) free[id[i]] = 0;
  }
};

struct ListFree {
  const int* free;
  const int* sums;
  int* ids;
  SIM_FN void operator()(int id) const {
    if (free[id]) ids[sums[id] - 1] = id;
  }
};

}  // namespace

void list_free_ids(Reads<Column::Id> p, const std::uint8_t* gone, Scanner& scanner, Array<int>& flags,
                   Array<int>& sums, Array<int>& ids) {
  const int capacity = p.capacity();
  const auto size = static_cast<std::size_t>(capacity);
  flags.resize(size);
  ids.resize(size);
  for_each("mark free ids", capacity, MarkFree{flags.data()});
  for_each("mark taken ids", p.size(), MarkTaken{p.id(), gone, flags.data(), capacity});
  scanner.inclusive_sum(flags, sums);
  for_each("list free ids", capacity, ListFree{flags.data(), sums.data(), ids.data()});
}

}  // namespace sim::SIM_BACKEND
