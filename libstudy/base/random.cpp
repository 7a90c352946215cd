#include "libstudy/base/random.hpp"

#include <string>

#include "stats/base/file.hpp"

namespace study {

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = 0xD2511F53ull * counter[0];
    const std::uint64_t b = 0xCD9E8D57ull * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

std::uint64_t counter_random(std::uint64_t key, std::uint64_t counter) {
  const auto low = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
  const auto high = [](std::uint64_t v) { return static_cast<std::uint32_t>(v >> 32); };
  const auto out = philox4x32({low(counter), high(counter), 0, 0}, {low(key), high(key)});
  return out[0] | static_cast<std::uint64_t>(out[1]) << 32;
}

std::uint64_t random_key(std::string_view text) {
  return std::stoull(base::sha256_hex(text).substr(0, 16), nullptr, 16);
}

std::uint64_t RandomStream::below(std::uint64_t bound) {
  const std::uint64_t reject =
      (0 - bound) % bound;  // 2^64 mod bound: rejecting smaller draws makes all remainders equally likely
  std::uint64_t draw = bits();
  while (draw < reject) draw = bits();
  return draw % bound;
}

double RandomStream::uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; }

}  // namespace study
