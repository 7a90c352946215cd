/// Any bytes as a PTPE file (ptpe.toml: a threshold curve of frame rates that a study fitted, for the
/// solver): refused with base::Error, or read. A file that was read must give the same text after it is
/// written and read again.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "libsim/ptpe/ptpe_file.hpp"
#include "stats/base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto file =
        sim::parse_ptpe_file(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
    const auto text = sim::format_ptpe_file(file);
    if (sim::format_ptpe_file(sim::parse_ptpe_file(text, "again")) != text) std::abort();
  } catch (const base::Error&) {
  }
  return 0;
}
