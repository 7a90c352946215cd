#pragma once
/// Particles as a structure of arrays. A column has memory only while a stage declares it, and a stage
/// accesses only the columns that it declares.

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "libsim/particles/columns.hpp"
#include "libsim/particles/divergence.hpp"
#include "libsim/particles/momentum.hpp"

namespace sim::SIM_BACKEND {

/// Counts of guard interventions on the device since the run began; sim::GuardCounts explains each count.
struct Guards {
  std::uint64_t speed_limited;
  std::uint64_t coincident_pairs;
  std::uint64_t not_finite;
  std::uint64_t neighbours_dropped;
  std::uint64_t wall_projected;
  std::uint64_t saliency_not_finite;
  Momentum braked;  ///< momentum removed by the speed limit, and from the particles that not_finite counts
  std::uint64_t first;  ///< largest TroubleKey that Witness noted since the run began; 0 = none
};

/// A 64-bit number for the time within a frame, the cause and the particle of a trouble. Earlier troubles of
/// a frame have larger keys: atomic_max finds the first, whatever the order of the threads.
struct TroubleKey {
  static constexpr std::uint64_t all = ~std::uint64_t{0};
  /// `half`: number of half substeps since the frame's start, 0 .. 2^24 - 1.
  SIM_FN static std::uint64_t of(int half, Trouble cause, int id) {
    return all - (static_cast<std::uint64_t>(half) << 40 | static_cast<std::uint64_t>(cause) << 32 |
                  static_cast<std::uint32_t>(id));
  }
  SIM_FN static Trouble cause(std::uint64_t key) { return static_cast<Trouble>((all - key) >> 32 & 0xff); }
  SIM_FN static int id(std::uint64_t key) { return static_cast<int>(static_cast<std::uint32_t>(all - key)); }
};

/// Records particles in trouble from within a pass.
struct Witness {
  Guards* guards;
  const int* id;
  int half;  ///< time of the pass, in half substeps since the frame's start (TroubleKey::of)
  SIM_FN void note(Trouble cause, int i) const {
    atomic_max(&guards->first, TroubleKey::of(half, cause, id[i]));
  }
};

/// Support radius of each mass level, m: cbrt(2^level) h_*, with the support h_* of level 0 (ViP-Fluid,
/// Eq. 10).
struct LevelSupports {
  static constexpr int most = 4;
  float h[most];
};
LevelSupports level_supports(double finest_support);

/// The arrays of all columns: n values if the column is allocated, otherwise none.
struct ColumnArrays {
#define SIM_MEMBER(Name, member, Type, ...) Array<Type> member;
#define SIM_NOTHING(...)
  SIM_COLUMNS(SIM_MEMBER, SIM_NOTHING)
#undef SIM_MEMBER
};

/// The particles' columns. Each neighbour search sorts the particles by cell.
class Particles {
 public:
  /// Allocates each column of the set for `capacity` particles (at least n), n of them in use, and frees the
  /// other columns.
  void allocate(ColumnSet set, int n, int capacity = 0);
  /// Allocates missing columns of the set with the same capacity as the present ones, and frees columns
  /// outside the set. New columns that splits and merges compute by rule (by_rule()) are set to 0. Columns
  /// that stay keep their values.
  void change_columns(ColumnSet set);
  int size() const { return n_; }
  int capacity() const { return capacity_; }
  bool has(Column column) const { return set_.has(column); }
  /// Sets the number of particles in use, at most the capacity. Remaining particles keep their values.
  void resize(int n);
  /// Memory of all columns and of the buffers for reordering, bytes.
  std::size_t bytes() const;

  /// Reorders all columns except scratch columns: new[i] = old[order[i]]. order.size() becomes the number of
  /// particles. A source may occur more than once (a split) or never (a merge).
  void reorder(const Array<int>& order);

  /// The columns that splits and merges compute by rule.
  Descents descents();
  /// Sets the columns of descents() to 0 for the start of a run.
  void begin_descents();

  /// Every column, for initialisation, read-outs and tests; passes use a ColumnView instead.
  ColumnArrays& all() { return columns_; }
  const ColumnArrays& all() const { return columns_; }

 private:
  /// Calls visit(column, declared, life, rule) for each column, in the table's order.
  template <class Self, class Visit>
  static void for_each_column(Self& self, Visit visit);
  /// The declared columns of one type that last as long as their particle.
  template <class T>
  std::vector<Array<T>*> kept_columns();

  int n_ = 0;
  int capacity_ = 0;
  ColumnSet set_;
  ColumnArrays columns_;
  // Destination buffers of reorder(), swapped with the columns.
  Array<Vec4> spare_a_, spare_b_, spare_c_;
  Array<int> spare_id_;
  Array<std::uint8_t> spare_level_;
  std::vector<Array<std::uint8_t>> spare_bytes_;
  std::vector<Array<float>> spare_floats_;
  std::vector<Array<int>> spare_ints_;
  std::vector<Array<Vec4>> spare_vectors_;
  std::vector<Array<SaliencyParts>> spare_parts_;
};

/// Access to exactly the columns that a pass declares. Each column is a function that returns a pointer to
/// its values, const unless the pass declares it as written. Undeclared access does not compile. IfThere:
/// columns that the pass reads only if the schedule allocates them for another pass; otherwise their function
/// returns nullptr. WritesIfThere: the same for columns that the pass writes. A view converts to a view that
/// declares less.
template <ColumnSet Reads, ColumnSet Writes, ColumnSet IfThere = ColumnSet{},
          ColumnSet WritesIfThere = ColumnSet{}>
class ColumnView {
 public:
  static constexpr ColumnSet reads = Reads;
  static constexpr ColumnSet writes = Writes;
  static constexpr ColumnSet may_read = Reads | Writes | IfThere | WritesIfThere;
  static constexpr ColumnSet may_write = Writes | WritesIfThere;

  explicit ColumnView(Particles& particles) : particles_(&particles) {}
  /// A view of constant particles; it must not declare written columns.
  explicit ColumnView(const Particles& particles) requires(may_write.empty())
      : particles_(const_cast<Particles*>(&particles)) {}
  /// Converts a view that declares at least the same columns.
  template <ColumnSet R, ColumnSet W, ColumnSet I, ColumnSet WI>
  requires((R | W).holds(Reads) && W.holds(Writes) && (R | W | I | WI).holds(may_read) &&
           (W | WI).holds(may_write)) ColumnView(const ColumnView<R, W, I, WI>& wider)
      : particles_(wider.particles_) {}

  int size() const { return particles_->size(); }
  int capacity() const { return particles_->capacity(); }
  bool has(Column column) const { return particles_->has(column); }

#define SIM_ACCESS(Name, member, Type, ...)                                    \
  std::conditional_t<may_write.has(Column::Name), Type*, const Type*> member() \
      const requires(may_read.has(Column::Name)) {                             \
    return particles_->all().member.data();                                    \
  }
  SIM_COLUMNS(SIM_ACCESS, SIM_NOTHING)
#undef SIM_ACCESS

  /// Copies the values of column From to column To.
  template <Column To, Column From>
  void copy() const requires(may_write.has(To) && may_read.has(From)) {
    const auto& from = array<From>();
    copy_within(array<To>().data(), from.data(), from.size() * sizeof(*from.data()));
  }
  template <Column A, Column B>
  void swap() const requires(may_write.has(A) && may_write.has(B)) {
    array<A>().swap(array<B>());
  }
  template <Column C, class T>
  void swap(Array<T>& values) const requires(may_write.has(C)) {
    array<C>().swap(values);
  }
  template <Column C>
  void zero() const requires(may_write.has(C)) {
    array<C>().zero();
  }

 private:
  template <ColumnSet R, ColumnSet W, ColumnSet I, ColumnSet WI>
  friend class ColumnView;

  template <Column C>
  auto& array() const {
#define SIM_CHOOSE(Name, member, ...) \
  if constexpr (C == Column::Name) return particles_->all().member;
    SIM_COLUMNS(SIM_CHOOSE, SIM_NOTHING)
#undef SIM_CHOOSE
  }

  Particles* particles_;
};
#undef SIM_NOTHING

/// A read-only view.
template <Column... C>
using Reads = ColumnView<columns(C...), ColumnSet{}>;

/// Lists in `ids` the unused ids below the capacity, in ascending order. Particles whose id is not below the
/// capacity are ignored. `gone`: flags of particles whose ids count as unused; nullptr: none. `flags` and
/// `sums` are scratch memory. The three arrays are resized to the capacity.
void list_free_ids(Reads<Column::Id> particles, const std::uint8_t* gone, Scanner& scanner, Array<int>& flags,
                   Array<int>& sums, Array<int>& ids);

}  // namespace sim::SIM_BACKEND
