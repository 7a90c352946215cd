#pragma once
/// Durations in words.

#include <string>

namespace base {

/// The duration in words: "40 s" below 90 s, "12 min" below two hours, else "3.5 h". `seconds` is 0 or more.
std::string duration_words(double seconds);

}  // namespace base
