#pragma once
/// Models written as text, such as "b1*(1-exp(-b2*x))", with derivatives by forward differentiation.

#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace formula {

constexpr std::size_t most_parameters = 12;

/// A value and its derivatives by b1, b2 ...
struct Dual {
  double value = 0;
  std::array<double, most_parameters> slope{};
};

inline Dual chain(const Dual& inner, double value, double derivative) {
  Dual out{value, {}};
  for (std::size_t i = 0; i < most_parameters; ++i) out.slope[i] = derivative * inner.slope[i];
  return out;
}

inline Dual combine(const Dual& a, const Dual& b, double value, double by_a, double by_b) {
  Dual out{value, {}};
  for (std::size_t i = 0; i < most_parameters; ++i) out.slope[i] = by_a * a.slope[i] + by_b * b.slope[i];
  return out;
}

inline Dual power(const Dual& a, const Dual& b) {
  const double value = std::pow(a.value, b.value);
  const double by_base = b.value == 0 ? 0 : b.value * std::pow(a.value, b.value - 1);
  return combine(a, b, value, by_base, a.value > 0 ? value * std::log(a.value) : 0);
}

/// Values that a formula refers to.
struct Point {
  std::vector<double> parameters, predictors;
};

using Node = std::function<Dual(const Point&)>;

/// Recursive descent: sum, product, sign, power, atom.
class Parser {
 public:
  explicit Parser(std::string text) : text_(std::move(text)) {}

  Node parse() {
    auto out = sum();
    if (peek() != '\0') throw std::invalid_argument("formula: left over: " + text_.substr(at_));
    return out;
  }

 private:
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(const std::string& token) {
    peek();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }

  Node sum() {
    auto left = product();
    while (true) {
      const bool minus = peek() == '-';
      if (!minus && peek() != '+') return left;
      ++at_;
      left = [left, right = product(), minus](const Point& p) {
        const auto a = left(p), b = right(p);
        return combine(a, b, minus ? a.value - b.value : a.value + b.value, 1, minus ? -1 : 1);
      };
    }
  }

  Node product() {
    auto left = sign();
    while (true) {
      const bool division = peek() == '/';
      if (!division && peek() != '*') return left;
      ++at_;
      left = [left, right = sign(), division](const Point& p) {
        const auto a = left(p), b = right(p);
        if (division) return combine(a, b, a.value / b.value, 1 / b.value, -a.value / (b.value * b.value));
        return combine(a, b, a.value * b.value, b.value, a.value);
      };
    }
  }

  Node sign() {
    if (take("+")) return sign();
    if (!take("-")) return powers();
    return [inner = sign()](const Point& p) {
      const auto a = inner(p);
      return chain(a, -a.value, -1);
    };
  }

  Node powers() {
    auto base = atom();
    if (!take("^") && !take("**")) return base;
    return [base, exponent = sign()](const Point& p) { return power(base(p), exponent(p)); };
  }

  Node atom() {
    const char next = peek();
    if (take("(") || take("[")) {
      auto inner = sum();
      if (!take(")") && !take("]")) throw std::invalid_argument("formula: a bracket stays open");
      return inner;
    }
    if (std::isdigit(static_cast<unsigned char>(next)) || next == '.') {
      std::size_t length = 0;
      const double value = std::stod(text_.substr(at_), &length);
      at_ += length;
      return [value](const Point&) { return Dual{value, {}}; };
    }
    std::string name;
    while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_]))) name += text_[at_++];
    return named(name);
  }

  Node named(const std::string& name) {
    if (name == "pi") return [](const Point&) { return Dual{std::numbers::pi, {}}; };
    if (name.size() > 1 && name[0] == 'b') {
      const auto i = std::stoul(name.substr(1)) - 1;
      return [i](const Point& p) {
        Dual out{p.parameters.at(i), {}};
        out.slope.at(i) = 1;
        return out;
      };
    }
    if (name[0] == 'x') {
      const auto i = name.size() == 1 ? 0 : std::stoul(name.substr(1)) - 1;
      return [i](const Point& p) { return Dual{p.predictors.at(i), {}}; };
    }
    return call(name, atom());
  }

  Node call(const std::string& name, Node inner) {
    using Rule = std::function<std::array<double, 2>(double)>;
    Rule rule;
    if (name == "exp") rule = [](double v) { return std::array{std::exp(v), std::exp(v)}; };
    if (name == "log") rule = [](double v) { return std::array{std::log(v), 1 / v}; };
    if (name == "sin") rule = [](double v) { return std::array{std::sin(v), std::cos(v)}; };
    if (name == "cos") rule = [](double v) { return std::array{std::cos(v), -std::sin(v)}; };
    if (name == "sqrt") rule = [](double v) { return std::array{std::sqrt(v), 0.5 / std::sqrt(v)}; };
    if (name == "arctan" || name == "atan")
      rule = [](double v) { return std::array{std::atan(v), 1 / (1 + v * v)}; };
    if (!rule) throw std::invalid_argument("formula: unknown function " + name);
    return [inner = std::move(inner), rule](const Point& p) {
      const auto a = inner(p);
      const auto [value, derivative] = rule(a.value);
      return chain(a, value, derivative);
    };
  }

  std::string text_;
  std::size_t at_ = 0;
};

}  // namespace formula
