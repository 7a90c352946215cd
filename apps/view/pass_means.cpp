#include "apps/view/pass_means.hpp"

#include <algorithm>
#include <numeric>

namespace apps {

namespace {

bool same_schedule(const std::vector<sim::StageTime>& a, const std::vector<sim::StageTime>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& p, const auto& q) { return p.name == q.name && p.phase == q.phase; });
}

}  // namespace

void PassMeans::push(const std::vector<sim::StageTime>& passes, double frame_s) {
  if (!same_schedule(passes, passes_)) {
    clear();
    passes_ = passes;
  }
  Frame frame{{}, frame_s};
  for (const auto& pass : passes) frame.ms.push_back(pass.ms);
  frames_.push_back(std::move(frame));
  seconds_ += frame_s;
  // Never removes the last frame, even if it took longer than span_s.
  while (frames_.size() > 1 && seconds_ > span_s) {
    seconds_ -= frames_.front().seconds;
    frames_.pop_front();
  }
}

std::vector<PassRow> PassMeans::rows() const {
  std::vector<PassRow> out;
  const double total = total_ms();
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    const auto& pass = passes_[i];
    PassRow row{pass.name, pass.phase, ""};
    if (pass.effect != sim::no_effect) row.effect = sim::traits_of(pass.effect).word;
    for (const auto& frame : frames_) row.ms += frame.ms[i] / static_cast<double>(frames_.size());
    row.share = total > 0 ? row.ms / total : 0;
    out.push_back(std::move(row));
  }
  return out;
}

double PassMeans::total_ms() const {
  double sum = 0;
  for (const auto& frame : frames_) sum = std::accumulate(frame.ms.begin(), frame.ms.end(), sum);
  return frames_.empty() ? 0 : sum / static_cast<double>(frames_.size());
}

}  // namespace apps
