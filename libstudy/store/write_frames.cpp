/// Frames of a presentation, as the session writes them.
#include "libstudy/store/store_statements.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// A time relative to another; nothing when it is not known.
std::optional<std::int64_t> after(std::int64_t time_ns, std::int64_t origin_ns) {
  if (time_ns < 0) return {};
  return time_ns - origin_ns;
}

std::optional<std::string> particles_text(const std::vector<std::int64_t>& particles) {
  if (particles.empty()) return {};
  std::string text;
  for (const auto count : particles) text += (text.empty() ? "" : " ") + std::to_string(count);
  return text;
}

/// Columns 10 to 23 of a frame; what nobody measured is NULL.
void bind_facts(Statement& insert, const FrameFacts& facts) {
  insert.bind(10, particles_text(facts.particles_by_level));
  for (int column = 11; column <= 23; ++column) insert.bind_null(column);
  if (const auto& t = facts.tolerance) {
    insert.bind(11, t->active_fraction).bind(12, t->tau_fps).bind(13, t->beta);
    insert.bind(14, t->mu_fps).bind(15, t->delta_fps);
  }
  if (const auto& g = facts.guards) {
    insert.bind(16, g->speed_limited).bind(17, g->coincident_pairs).bind(18, g->not_finite);
    insert.bind(19, g->neighbours_dropped).bind(20, g->wall_projected).bind(21, g->nozzle_waited);
    insert.bind(22, g->saliency_not_finite).bind(23, g->gaze_lost);
  }
}

}  // namespace

void Store::insert_frames(std::int64_t presentation, std::int64_t start_ns,
                          std::span<const FrameRecord> frames) {
  Statement& insert = statements_->frame;
  for (const FrameRecord& frame : frames) {
    const std::int64_t due = frame.scheduled_ns;
    insert.bind(0, presentation).bind(1, frame.index).bind(2, frame.content_step);
    insert.bind(3, frame.facts.simulation_time_s).bind(4, due - start_ns);
    insert.bind(5, after(frame.times.submitted_ns, due)).bind(6, after(frame.times.gpu_done_ns, due));
    insert.bind(7, after(frame.times.predicted_display_ns, due))
        .bind(8, after(frame.times.actual_display_ns, due));
    insert.bind(9, frame.late ? 1 : 0);
    bind_facts(insert, frame.facts);
    insert.run();
  }
}

void Store::add_frames(std::int64_t presentation, std::int64_t start_ns,
                       std::span<const FrameRecord> frames) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  commit(transaction);
}

}  // namespace study
