#pragma once
/// The columns that splits and merges treat by the rule of their row (columns.hpp), as kernels see them.

#include <cstdint>
#include <type_traits>

#include "libsim/particles/columns.hpp"

namespace sim::SIM_BACKEND {

/// A rule that needs no pass of the column's own.
constexpr bool by_rule(Descent rule) {
  return rule == Descent::MassMean || rule == Descent::Sum || rule == Descent::Max || rule == Descent::Reset;
}

/// Scratch columns have no rule and all others have one. What is averaged or added is a float; bytes have a
/// largest and are reset; other types are copied or treated by name.
template <class T>
constexpr bool may_descend(Life life, Descent rule) {
  if ((life == Life::Scratch) != (rule == Descent::None)) return false;
  if (!by_rule(rule) || std::is_same_v<T, float>) return true;
  return std::is_same_v<T, std::uint8_t> && (rule == Descent::Max || rule == Descent::Reset);
}
#define SIM_CHECK(Name, member, Type, life, rule) \
  static_assert(may_descend<Type>(Life::life, Descent::rule), #Name " cannot split and merge so");
#define SIM_NOTHING(...)
SIM_COLUMNS(SIM_CHECK, SIM_NOTHING)
#undef SIM_CHECK

/// How many columns of a type live with their particle, and how many of them have such a rule.
template <class T>
constexpr int kept_count() {
  int sum = 0;
#define SIM_COUNT(Name, member, Type, life, rule) sum += std::is_same_v<Type, T> && Life::life == Life::Kept;
  SIM_COLUMNS(SIM_COUNT, SIM_NOTHING)
#undef SIM_COUNT
  return sum;
}
template <class T>
constexpr int ruled_count() {
  int sum = 0;
#define SIM_COUNT(Name, member, Type, life, rule) sum += std::is_same_v<Type, T> && by_rule(Descent::rule);
  SIM_COLUMNS(SIM_COUNT, SIM_NOTHING)
#undef SIM_COUNT
  return sum;
}

/// The columns with such a rule, which begin at 0 and have been written before any pass reads them.
constexpr ColumnSet ruled_columns() {
  ColumnSet out;
#define SIM_ADD(Name, member, Type, life, rule) \
  if (by_rule(Descent::rule)) out |= columns(Column::Name);
  SIM_COLUMNS(SIM_ADD, SIM_NOTHING)
#undef SIM_ADD
#undef SIM_NOTHING
  return out;
}

/// Those of one type that are there.
template <class T>
struct RuledColumns {
  T* values[ruled_count<T>()];
  Descent rule[ruled_count<T>()];
  int count;

  /// Of a particle that is a copy of its parent, one of `children` of equal mass.
  SIM_FN void split(int i, int children) const {
    for (int k = 0; k < count; ++k) {
      if (rule[k] == Descent::Reset) values[k][i] = 0;
      if constexpr (std::is_same_v<T, float>)
        if (rule[k] == Descent::Sum) values[k][i] /= static_cast<float>(children);
    }
  }
  /// Two of equal mass become one, in the place of `kept`.
  SIM_FN void join(int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      v[kept] = met(rule[k], v[kept], v[left], 1);
    }
  }
  /// Each of two gets a half of j, which has their masses' sum and goes on as one of the two.
  SIM_FN void share(int j, int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      const T whole = v[j];
      v[kept] = met(rule[k], v[kept], whole, 0.5f);
      v[j] = met(rule[k], v[left], whole, 0.5f);
    }
  }
  /// Of a particle that none was before.
  SIM_FN void make(int i) const {
    for (int k = 0; k < count; ++k) values[k][i] = 0;
  }

 private:
  /// What meets an equal mass, which is `share` of a particle with b.
  SIM_FN static T met(Descent rule, T a, T b, float share) {
    if (rule == Descent::Reset) return 0;
    if (rule == Descent::Max) return a > b ? a : b;
    if constexpr (std::is_same_v<T, float>) return rule == Descent::Sum ? a + share * b : 0.5f * (a + b);
    return a;
  }
};

/// All that are there.
struct Descents {
  RuledColumns<float> floats;
  RuledColumns<std::uint8_t> bytes;

  SIM_FN void split(int i, int children) const {
    floats.split(i, children);
    bytes.split(i, children);
  }
  SIM_FN void join(int kept, int left) const {
    floats.join(kept, left);
    bytes.join(kept, left);
  }
  SIM_FN void share(int j, int kept, int left) const {
    floats.share(j, kept, left);
    bytes.share(j, kept, left);
  }
  SIM_FN void make(int i) const {
    floats.make(i);
    bytes.make(i);
  }
};

}  // namespace sim::SIM_BACKEND
