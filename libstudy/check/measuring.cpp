#include "libstudy/check/measuring.hpp"

#include <algorithm>

namespace study {

namespace {

constexpr double patience_s = 5;

const Cell& cell_of(const Protocol& protocol, int index) {
  return protocol.design.cells.at(static_cast<std::size_t>(index));
}

double seconds(const Clock& clock) { return 1e-9 * static_cast<double>(clock.now_ns()); }

/// True if measure() must still measure content step `step` for this cell: the step is in the cell's trial,
/// and the measurement is not behind the cell's schedule. In the first patience_s seconds the measurement may
/// be behind.
bool wants(const Protocol& protocol, const Cell& cell, double refresh_hz, std::int64_t step, double gone_s) {
  const std::int64_t steps = content_steps(protocol, cell.setting, refresh_hz);
  if (step >= steps) return false;
  if (gone_s < patience_s) return true;
  if (cell.setting.mean == 0) return gone_s < cell.setting.duration_s;
  return static_cast<double>(step) * cell.setting.duration_s >= gone_s * static_cast<double>(steps);
}

}  // namespace

double longest_measuring_s(const Protocol& protocol, const MeasuredStimulus& what) {
  double longest = patience_s;
  for (const int cell : what.cells) longest = std::max(longest, cell_of(protocol, cell).setting.duration_s);
  return longest;
}

StepTimes measure(const Protocol& protocol, const std::vector<int>& cells, Stimulus& stimulus,
                  Display& display, Clock& clock, double refresh_hz, const std::function<void()>& each) {
  const std::int64_t start = protocol.content.start_frame;
  stimulus.start(start);
  stimulus.prepare(start);
  display.render(stimulus);
  StepTimes out{{0}, {0}};
  const double begun_s = seconds(clock);
  const auto wanted = [&](std::int64_t step) {
    return std::any_of(cells.begin(), cells.end(), [&](int cell) {
      return wants(protocol, cell_of(protocol, cell), refresh_hz, step, seconds(clock) - begun_s);
    });
  };
  for (std::int64_t step = 1; wanted(step); ++step) {
    const double before_s = seconds(clock);
    stimulus.prepare(start + step);
    const double computed_s = seconds(clock);
    display.render(stimulus);
    out.compute_s.push_back(computed_s - before_s);
    out.draw_s.push_back(seconds(clock) - computed_s);
    if (each) each();
  }
  return out;
}

}  // namespace study
