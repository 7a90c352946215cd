#pragma once
/// Random numbers as a pure function of (key, counter): equal on every machine, build and thread count.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace study {

/// The random generator Philox4x32 with 10 rounds (Salmon, Moraes, Dror and Shaw, "Parallel random numbers:
/// as easy as 1, 2, 3", SC 2011). It passes the test battery BigCrush of TestU01. The counter has 128 bits,
/// the key 64 bits, both with the least significant word first.
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// The first 64 bits of philox4x32 for (key, counter).
std::uint64_t counter_random(std::uint64_t key, std::uint64_t counter);

/// A 64-bit key computed from a text: the first 16 hexadecimal digits of the text's SHA-256.
std::uint64_t random_key(std::string_view text);

/// A sequence of random numbers with a fixed key. Each call of bits() advances the counter by 1.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t key, std::uint64_t first_counter = 0)
      : key_(key), counter_(first_counter) {}
  std::uint64_t bits() { return counter_random(key_, counter_++); }
  /// A random integer, uniform on 0 ... bound - 1. Rejection avoids a modulo bias. bound >= 1.
  std::uint64_t below(std::uint64_t bound);
  /// A random number, uniform on the open interval (0, 1), with 53 random bits.
  double uniform();

 private:
  std::uint64_t key_;
  std::uint64_t counter_;
};

/// Shuffles `items` (Fisher-Yates, as in Durstenfeld 1964): every permutation is equally likely.
template <typename T>
void shuffle(std::vector<T>& items, RandomStream& random) {
  for (std::size_t left = items.size(); left > 1; --left)
    std::swap(items[left - 1], items[random.below(left)]);
}

}  // namespace study
