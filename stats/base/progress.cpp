#include "stats/base/progress.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <utility>

#include "stats/base/duration.hpp"

namespace base {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(total),
      started_s_(seconds_now()),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_ && drawn_s_ > 0) std::fputc('\n', stderr);
}

void Progress::update(std::size_t done) {
  const double now = seconds_now();
  if (now - started_s_ < 2 || done == 0) return;
  const int tenth = total_ ? static_cast<int>(10 * done / total_) : 0;
  if (terminal_ ? (now - drawn_s_ < 0.1 && done < total_) : tenth == drawn_tenth_) return;
  drawn_s_ = now;
  drawn_tenth_ = tenth;
  draw(done);
}

void Progress::draw(std::size_t done) {
  const double fraction = total_ ? static_cast<double>(done) / static_cast<double>(total_) : 0;
  const double elapsed = seconds_now() - started_s_;
  const double left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
  constexpr int width = 30;
  std::string bar(width, '.');
  for (int i = 0; i < static_cast<int>(fraction * width); ++i) bar[static_cast<std::size_t>(i)] = '#';
  std::fprintf(stderr, "%s%s [%s] %3.0f %%  %s left%s", terminal_ ? "\r" : "", label_.c_str(), bar.c_str(),
               100 * fraction, duration_words(left).c_str(), terminal_ ? "   " : "\n");
  std::fflush(stderr);
}

}  // namespace base
