#pragma once
/// Times of the renderer's passes over many pictures.

#include <span>
#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "stats/base/json.hpp"

namespace measure {

/// Milliseconds of each pass per picture.
class PassTable {
 public:
  void add(std::span<const sim::PassTime> picture);
  void clear() { passes_.clear(); }
  bool empty() const { return passes_.empty(); }
  /// A JSON object with the median of each pass.
  base::Json figures() const;

 private:
  struct Pass {
    std::string name;
    std::vector<double> ms;
  };
  std::vector<Pass> passes_;
};

/// Prints PassTable::figures(), the longest pass first, and their sum.
void print_passes(const base::Json& figures);

}  // namespace measure
