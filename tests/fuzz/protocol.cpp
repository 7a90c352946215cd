/// Protocol files: any bytes either parse or give base::Error.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    study::parse_protocol({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  } catch (const base::Error&) {
  }
  return 0;
}
