#include "libsim/particles/particles.hpp"

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

template <class T>
void fit(Array<T>& column, bool wanted, std::size_t n) {
  if (wanted) {
    column.resize(n);
  } else {
    column = Array<T>();
  }
}

}  // namespace

const char* column_name(Column column) {
  constexpr std::array<const char*, static_cast<std::size_t>(Column::count)> names{
      "position",       "velocity",      "id",     "level",   "predicted",
      "predicted_next", "velocity_next", "lambda", "density", "neighbours"};
  return names[static_cast<std::size_t>(column)];
}

void Particles::allocate(ColumnSet set, int n) {
  n_ = n;
  set_ = set;
  const auto size = static_cast<std::size_t>(n);
  const auto wanted = [&](Column column) { return set.test(static_cast<std::size_t>(column)); };
  fit(position, wanted(Column::Position), size);
  fit(velocity, wanted(Column::Velocity), size);
  fit(id, wanted(Column::Id), size);
  fit(level, wanted(Column::Level), size);
  fit(predicted, wanted(Column::Predicted), size);
  fit(predicted_next, wanted(Column::PredictedNext), size);
  fit(velocity_next, wanted(Column::VelocityNext), size);
  fit(lambda, wanted(Column::Lambda), size);
  fit(density, wanted(Column::Density), size);
}

std::size_t Particles::bytes() const {
  return position.bytes() + velocity.bytes() + predicted.bytes() + predicted_next.bytes() +
         velocity_next.bytes() + id.bytes() + level.bytes() + lambda.bytes() + density.bytes() +
         spare_a_.bytes() + spare_b_.bytes() + spare_c_.bytes() + spare_id_.bytes() + spare_level_.bytes();
}

void Particles::reorder(const Array<int>& order) {
  const auto size = static_cast<std::size_t>(n_);
  spare_a_.resize(size);
  spare_b_.resize(size);
  spare_c_.resize(size);
  spare_id_.resize(size);
  spare_level_.resize(size);
  for_each("reorder", n_,
           Gather{order.data(), position.data(), predicted.data(), velocity.data(), id.data(), level.data(),
                  spare_a_.data(), spare_b_.data(), spare_c_.data(), spare_id_.data(), spare_level_.data()});
  position.swap(spare_a_);
  predicted.swap(spare_b_);
  velocity.swap(spare_c_);
  id.swap(spare_id_);
  level.swap(spare_level_);
}

}  // namespace sim::SIM_BACKEND
