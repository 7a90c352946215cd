#include "stats/base/program.hpp"

#include <cstddef>

#include "stats/base/file.hpp"

namespace base {

const std::string& program_digest() {
  static const std::string digest = sha256_hex(read_file("/proc/self/exe", std::size_t{1} << 32));
  return digest;
}

std::string program_words() { return version() + " " + program_digest().substr(0, 16); }

}  // namespace base
