#include "libstudy/observer/adversaries.hpp"

#include "libstudy/base/random.hpp"
#include "libstudy/observer/specification.hpp"

namespace study {

std::optional<std::string> ConstantObserver::simulated() const {
  return "constant:" + shortest_number(score_);
}

std::optional<std::string> DropoutObserver::simulated() const {
  return "dropout:" + shortest_number(probability_) + "," + answers_->simulated().value();
}

void DropoutObserver::before_trial(const Occasion& occasion) {
  const std::uint64_t key =
      random_key("leaves\n" + std::to_string(occasion.seed) + '\n' + occasion.participant);
  if (uniform_of(key, static_cast<std::uint64_t>(occasion.position)) < probability_) throw Left();
}

}  // namespace study
