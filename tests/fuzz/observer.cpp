/// Any bytes as the specification of a simulated observer: refused with base::Error, or read. An observer
/// that was read prints a specification, which must be read as an observer with the same specification.
#include "libstudy/observer/observer.hpp"

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "libstudy/observer/picture_features.hpp"
#include "tests/fuzz/attempt.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static study::FeatureTable features;
  fuzz::attempt([&] {
    const auto observer = study::make_observer({reinterpret_cast<const char*>(data), size}, features);
    const std::string words = observer->simulated().value();
    if (study::make_observer(words, features)->simulated() != words) std::abort();
  });
  return 0;
}
