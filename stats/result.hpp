#pragma once
/// A value, or the reason why it is undefined. Tests and estimates return a Result where they may be
/// undefined.

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace stats {

/// Why a quantity is not defined for the data given, as a phrase without a full stop.
struct Refusal {
  std::string reason;
};

template <class T>
class Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Refusal refusal) : state_(std::move(refusal)) {}

  explicit operator bool() const { return std::holds_alternative<T>(state_); }
  /// Throws std::logic_error when there is no value.
  const T& value() const {
    if (!*this) throw std::logic_error("no value: " + reason());
    return std::get<T>(state_);
  }
  const T& operator*() const { return value(); }
  const T* operator->() const { return &value(); }
  /// Empty when there is a value.
  std::string reason() const { return *this ? std::string() : std::get<Refusal>(state_).reason; }

 private:
  std::variant<T, Refusal> state_;
};

}  // namespace stats
