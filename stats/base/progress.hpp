#pragma once
/// Progress of a long step on stderr.

#include <cstddef>
#include <string>

namespace base {

/// Shows the progress of a long step on stderr: a line redrawn at most ten times a second, or one plain line
/// per tenth of the work if stderr is not a terminal. Shows nothing for steps that end within two seconds.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(std::size_t done);

 private:
  void draw(std::size_t done);

  std::string label_;
  std::size_t total_;
  double started_s_;
  double drawn_s_ = 0;
  int drawn_tenth_ = -1;
  bool terminal_;
};

}  // namespace base
