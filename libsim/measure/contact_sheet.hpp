#pragma once
/// Pictures of the five methods side by side, as in Fig. 7 and 8 of the paper.

#include <filesystem>
#include <future>
#include <vector>

#include "libsim/gl/png.hpp"

namespace measure {

/// One column per method: its picture above the same picture painted by level.
struct SheetColumn {
  sim::Image picture, levels;
};

/// Joins columns of equal size, left to right.
sim::Image contact_sheet(const std::vector<SheetColumn>& columns);

/// Writes each PNG file on a thread of its own, because compression takes longer than drawing. finish() must
/// be called: it waits for the files and throws the first error of writing.
class SheetWriter {
 public:
  void write(std::filesystem::path path, sim::Image image);
  void finish();

 private:
  std::vector<std::future<void>> pending_;
};

}  // namespace measure
