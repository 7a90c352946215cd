/// The columns (arrays with one value for each particle) that each pass reads and writes.

#include <concepts>
#include <type_traits>

#include "libsim/solver/schedule.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

template <class View>
concept GivesVelocity = requires(View view) {
  view.velocity();
};
template <class View>
concept SwapsVelocity = requires(View view) {
  view.template swap<Column::Velocity, Column::VelocityNext>();
};

using OnlyPosition = ColumnView<columns(Column::Position), ColumnSet{}>;
using ReadsVelocity = ColumnView<columns(Column::Position, Column::Velocity), ColumnSet{}>;
using WritesVelocity = ColumnView<columns(Column::Position), columns(Column::Velocity)>;
using MayReadVelocity = ColumnView<columns(Column::Position), ColumnSet{}, columns(Column::Velocity)>;
using MayWriteVelocity =
    ColumnView<columns(Column::Position), ColumnSet{}, ColumnSet{}, columns(Column::Velocity)>;

SIM_TEST(Columns, AreReachedAsTheyAreDeclared) {
  static_assert(!GivesVelocity<OnlyPosition>);
  static_assert(std::same_as<decltype(std::declval<ReadsVelocity>().velocity()), const Vec4*>);
  static_assert(std::same_as<decltype(std::declval<MayReadVelocity>().velocity()), const Vec4*>);
  static_assert(std::same_as<decltype(std::declval<WritesVelocity>().velocity()), Vec4*>);
  static_assert(std::same_as<decltype(std::declval<MayWriteVelocity>().velocity()), Vec4*>);
  static_assert(!SwapsVelocity<WritesVelocity>);
}

SIM_TEST(Columns, AreLentToPassesThatDeclareNoMore) {
  static_assert(std::is_convertible_v<ReadsVelocity, OnlyPosition>);
  static_assert(std::is_convertible_v<WritesVelocity, ReadsVelocity>);
  static_assert(std::is_convertible_v<ReadsVelocity, MayReadVelocity>);
  static_assert(!std::is_convertible_v<OnlyPosition, ReadsVelocity>);
  static_assert(!std::is_convertible_v<ReadsVelocity, WritesVelocity>);
  static_assert(!std::is_convertible_v<MayReadVelocity, ReadsVelocity>);
  static_assert(!std::is_convertible_v<MayWriteVelocity, WritesVelocity>);
  static_assert(!std::is_constructible_v<WritesVelocity, const Particles&>);
}

SIM_TEST(Columns, ThatNobodyCallsForAreNull) {
  Particles particles;
  particles.allocate(columns(Column::Position), 10);
  EXPECT_NE(MayReadVelocity(particles).position(), nullptr);
  EXPECT_EQ(MayReadVelocity(particles).velocity(), nullptr);
  particles.allocate(columns(Column::Position, Column::Velocity), 10);
  EXPECT_NE(MayReadVelocity(particles).velocity(), nullptr);
}

SIM_TEST(Columns, OfEachStageAreThoseOfItsView) {
  const Stage predict = predict_stage();
  EXPECT_EQ(predict.reads.bits, columns(Column::Position, Column::Velocity, Column::Id).bits);
  EXPECT_EQ(predict.writes.bits, columns(Column::Predicted, Column::Position, Column::Velocity).bits);
  // Columns that a pass uses only if another pass needs them cost no memory.
  const Schedule hires = compile_schedule({});
  for (const Column column : {Column::Ease, Column::Active, Column::Target, Column::Saliency})
    EXPECT_FALSE(hires.columns.has(column)) << column_name(column);
}

SIM_TEST(Columns, SplitAndMergeByTheRuleOfTheirRow) {
  static_assert(may_descend<float>(Life::Kept, Descent::MassMean));
  static_assert(may_descend<Vec4>(Life::Kept, Descent::Copy));
  static_assert(may_descend<float>(Life::Scratch, Descent::None));
  static_assert(!may_descend<float>(Life::Kept, Descent::None), "a column that lives needs a rule");
  static_assert(!may_descend<float>(Life::Core, Descent::None));
  static_assert(!may_descend<float>(Life::Scratch, Descent::Copy), "scratch has none");
  static_assert(!may_descend<std::uint8_t>(Life::Kept, Descent::MassMean), "a byte has no mean");
  static_assert(!may_descend<int>(Life::Kept, Descent::Sum));
  static_assert(ruled_columns().bits ==
                columns(Column::Waiting, Column::Age, Column::Temperature, Column::Swirl).bits);
}

/// The values of three particles in one column (8, 2, 6) after `change`, in which particle 0 splits or is
/// shared out, and particles 1 and 2 merge with each other or each with a half of particle 0. `rule` says how
/// the column gives values to new and merged particles: by their mean or sum, by the larger value, or as 0.
std::vector<float> after(Descent rule, void (*change)(const RuledColumns<float>&)) {
  std::vector<float> values{8, 2, 6};
  RuledColumns<float> column{};
  column.values[0] = values.data();
  column.rule[0] = rule;
  column.count = 1;
  change(column);
  return values;
}
SIM_TEST(Columns, RulesAreWhatTheySay) {
  const auto split = [](const RuledColumns<float>& c) { c.split(0, 4); };
  EXPECT_EQ(after(Descent::MassMean, split)[0], 8);
  EXPECT_EQ(after(Descent::Sum, split)[0], 2);
  EXPECT_EQ(after(Descent::Max, split)[0], 8);
  EXPECT_EQ(after(Descent::Reset, split)[0], 0);
  const auto join = [](const RuledColumns<float>& c) { c.join(1, 2); };
  EXPECT_EQ(after(Descent::MassMean, join)[1], 4);
  EXPECT_EQ(after(Descent::Sum, join)[1], 8);
  EXPECT_EQ(after(Descent::Max, join)[1], 6);
  EXPECT_EQ(after(Descent::Reset, join)[1], 0);
  // Masses are 2, 1, 1 before and 2, 2, none after: sharing conserves sum m x (MassMean) or sum x (Sum).
  const auto share = [](const RuledColumns<float>& c) { c.share(0, 1, 2); };
  EXPECT_EQ(after(Descent::MassMean, share), (std::vector<float>{7, 5, 6}));
  EXPECT_EQ(after(Descent::Sum, share), (std::vector<float>{10, 6, 6}));
  EXPECT_EQ(after(Descent::Max, share), (std::vector<float>{8, 8, 6}));
  EXPECT_EQ(after(Descent::Reset, share), (std::vector<float>{0, 0, 6}));
}

SIM_TEST(Columns, FollowTheirParticlesWhenTheyAreKept) {
  Particles particles;
  particles.allocate(all_columns(), 3);
  auto& c = particles.all();
  c.position.zero();
  c.velocity.zero();
  c.predicted.zero();
  for (auto* bytes : {&c.target, &c.history, &c.waiting, &c.active}) bytes->zero();
  c.saliency_parts.zero();
  c.unrest.zero();
  c.swirl.zero();
  c.temperature.from_host({1.5f, 2.5f, 3.5f});
  c.id.from_host({7, 8, 9});
  c.level.from_host({0, 1, 2});
  c.age.from_host({10, 11, 12});
  c.saliency.from_host({0.1f, 0.2f, 0.3f});
  c.start_cell.from_host({4, 5, 6});
  Array<int> order;
  order.from_host({2, 0});
  particles.reorder(order);
  EXPECT_EQ(particles.size(), 2);
  EXPECT_EQ(c.id.to_host(), (std::vector<int>{9, 7}));
  EXPECT_EQ(c.level.to_host(), (std::vector<std::uint8_t>{2, 0}));
  EXPECT_EQ(c.age.to_host(), (std::vector<std::uint8_t>{12, 10}));
  EXPECT_EQ(c.saliency.to_host(), (std::vector<float>{0.3f, 0.1f}));
  EXPECT_EQ(c.start_cell.to_host(), (std::vector<int>{6, 4}));
  EXPECT_EQ(c.temperature.to_host(), (std::vector<float>{3.5f, 1.5f}));
}

}  // namespace
}  // namespace sim::SIM_BACKEND
