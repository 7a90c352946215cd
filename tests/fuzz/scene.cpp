/// Any bytes as a scene file: parsed, or refused with base::Error.

#include <cstdint>
#include <string_view>

#include "libsim/scene/scene.hpp"
#include "stats/base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    sim::parse_scene(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  } catch (const base::Error&) {
  }
  return 0;
}
