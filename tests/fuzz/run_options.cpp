/// Any bytes as the options of `vip-study run`, which a database stores for resuming: refused with
/// base::Error, or read. Options that were read must be equal after they are written and read again.
#include "libstudy/runner/run_options.hpp"

#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/attempt.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::attempt([&] {
    const auto options = study::parse_run_options({reinterpret_cast<const char*>(data), size}, "fuzz.db");
    if (study::parse_run_options(study::format_run_options(options), "again") != options) std::abort();
  });
  return 0;
}
