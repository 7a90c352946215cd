#include "libstudy/markers/lsl_library.hpp"

#include <cstdlib>

#include "stats/base/error.hpp"

namespace study {

void* open_lsl_library(const std::string& place) {
  const char* other = std::getenv("VIP_LSL_LIBRARY");
  if (other && *other) {
    if (void* library = ::dlopen(other, RTLD_NOW | RTLD_LOCAL)) return library;
    throw base::Error(place, std::string("VIP_LSL_LIBRARY names ") + other + ", which cannot be loaded",
                      "correct its path, or unset VIP_LSL_LIBRARY");
  }
  for (const char* name : {"liblsl.so.2", "liblsl.so.1", "liblsl.so", "liblsl64.so"}) {
    if (void* library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
  }
  throw base::Error(
      place, "there is no liblsl on this machine",
      "install liblsl from github.com/sccn/liblsl/releases, or name the library in VIP_LSL_LIBRARY");
}

void refuse_lsl_library(const std::string& place, const char* name) {
  throw base::Error(place, std::string("the library that was found for LSL has no ") + name,
                    "install liblsl 1.13 or newer, or name it in VIP_LSL_LIBRARY");
}

}  // namespace study
