#pragma once
/// Columns whose values splits and merges compute by the rule of their row (columns.hpp), for kernels.

#include <cstdint>
#include <type_traits>

#include "libsim/particles/columns.hpp"

namespace sim::SIM_BACKEND {

/// True for rules that need no code specific to the column.
constexpr bool by_rule(Descent rule) {
  return rule == Descent::MassMean || rule == Descent::Sum || rule == Descent::Max || rule == Descent::Reset;
}

/// True if a column of type T may have this lifetime and rule: scratch columns have no rule and all others
/// have one. Mean and sum need float; bytes allow maximum and reset; other types are copied or handled by
/// name.
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

/// The number of columns of a type that last as long as their particle, and how many of them have such a
/// rule.
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

/// The columns with such a rule; they start at 0 and are written before any pass reads them.
constexpr ColumnSet ruled_columns() {
  ColumnSet out;
#define SIM_ADD(Name, member, Type, life, rule) \
  if (by_rule(Descent::rule)) out |= columns(Column::Name);
  SIM_COLUMNS(SIM_ADD, SIM_NOTHING)
#undef SIM_ADD
#undef SIM_NOTHING
  return out;
}

/// The allocated columns of one type.
template <class T>
struct RuledColumns {
  T* values[ruled_count<T>()];
  Descent rule[ruled_count<T>()];
  int count;

  /// For particle i, a copy of its parent, one of `children` of equal mass.
  SIM_FN void split(int i, int children) const {
    for (int k = 0; k < count; ++k) {
      if (rule[k] == Descent::Reset) values[k][i] = 0;
      if constexpr (std::is_same_v<T, float>)
        if (rule[k] == Descent::Sum) values[k][i] /= static_cast<float>(children);
    }
  }
  /// Merges two particles of equal mass into `kept`.
  SIM_FN void join(int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      v[kept] = met(rule[k], v[kept], v[left], 1);
    }
  }
  /// j has the mass of `kept` and `left` together. One half of j merges with `kept`, the other with `left`;
  /// the results are in `kept` and in j.
  SIM_FN void share(int j, int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      const T whole = v[j];
      v[kept] = met(rule[k], v[kept], whole, 0.5f);
      v[j] = met(rule[k], v[left], whole, 0.5f);
    }
  }
  /// For a new particle without a parent.
  SIM_FN void make(int i) const {
    for (int k = 0; k < count; ++k) values[k][i] = 0;
  }

 private:
  /// Merges a with an equal mass taken from a particle with value b; `share`: mass taken over its mass.
  SIM_FN static T met(Descent rule, T a, T b, float share) {
    if (rule == Descent::Reset) return 0;
    if (rule == Descent::Max) return a > b ? a : b;
    if constexpr (std::is_same_v<T, float>) return rule == Descent::Sum ? a + share * b : 0.5f * (a + b);
    return a;
  }
};

/// All allocated columns with such rules.
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
