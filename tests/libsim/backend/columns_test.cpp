/// What a pass reaches of the particles' columns.

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
  // What a pass may touch where others call for it costs no memory.
  const Schedule hires = compile_schedule({});
  for (const Column column : {Column::Ease, Column::Active, Column::Target, Column::Saliency})
    EXPECT_FALSE(hires.columns.has(column)) << column_name(column);
}

SIM_TEST(Columns, FollowTheirParticlesWhenTheyAreKept) {
  Particles particles;
  particles.allocate(all_columns(), 3);
  auto& c = particles.all();
  c.position.zero();
  c.velocity.zero();
  c.predicted.zero();
  for (auto* bytes : {&c.target, &c.history, &c.waiting, &c.active, &c.rest}) bytes->zero();
  c.saliency_parts.zero();
  c.unrest.zero();
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
}

}  // namespace
}  // namespace sim::SIM_BACKEND
