#include "libstudy/sweep/cell_run.hpp"

namespace study {

std::string to_bits(const std::vector<std::uint8_t>& mask) {
  std::string out((mask.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i]) out[i / 8] = static_cast<char>(out[i / 8] | (1 << (i % 8)));
  return out;
}

std::vector<std::uint8_t> from_bits(const std::string& bits, std::size_t pixels) {
  if (8 * bits.size() < pixels) return {};
  std::vector<std::uint8_t> out(pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    out[i] = static_cast<std::uint8_t>((static_cast<unsigned char>(bits[i / 8]) >> (i % 8)) & 1);
  return out;
}

}  // namespace study
