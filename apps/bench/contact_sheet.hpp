#pragma once
/// Pictures of the five methods beside each other, as in Fig. 7 and 8 of the paper.

#include <filesystem>
#include <future>
#include <vector>

#include "libsim/render/png.hpp"

namespace apps {

/// One column a method: its picture above the same painted by level.
struct SheetColumn {
  sim::Image picture, levels;
};

/// Columns of equal pictures, left to right.
sim::Image contact_sheet(const std::vector<SheetColumn>& columns);

/// Writes PNG files on threads of its own, since packing takes longer than drawing. Errors are thrown by
/// finish(), which must be called.
class SheetWriter {
 public:
  void write(std::filesystem::path path, sim::Image image);
  void finish();

 private:
  std::vector<std::future<void>> pending_;
};

}  // namespace apps
