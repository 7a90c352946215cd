#pragma once
/// The renderer's passes over many pictures.

#include <span>
#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// Milliseconds of each pass, picture by picture.
class PassTable {
 public:
  void add(std::span<const sim::PassTime> picture);
  void clear() { passes_.clear(); }
  bool empty() const { return passes_.empty(); }
  /// An object: the median of each pass.
  base::Json figures() const;

 private:
  struct Pass {
    std::string name;
    std::vector<double> ms;
  };
  std::vector<Pass> passes_;
};

/// The lines of PassTable::figures(), the longest pass first, and their sum.
void print_passes(const base::Json& figures);

}  // namespace apps
