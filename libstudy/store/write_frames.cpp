/// Store: writes the frames of a presentation.
#include "libstudy/store/store_statements.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// A time relative to another; none if it is not known.
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

/// A member of an optional part of a frame; none if the frame lacks the part.
template <class Part, class Value>
std::optional<Value> part(const std::optional<Part>& whole, Value Part::*member) {
  if (!whole) return {};
  return (*whole).*member;
}
template <class Part, class Value>
std::optional<Value> part(const std::optional<Part>& whole, std::optional<Value> Part::*member) {
  if (!whole) return {};
  return (*whole).*member;
}

}  // namespace

void Store::insert_frames(std::int64_t presentation, std::int64_t start_ns,
                          std::span<const FrameRecord> frames) {
  Statement& insert = statements_->frame;
  for (const FrameRecord& frame : frames) {
    const std::int64_t due = frame.scheduled_ns;
    const FrameFacts& facts = frame.facts;
    insert
        .bind_all(
            presentation, frame.index, frame.content_step, facts.simulation_time_s, due - start_ns,
            after(frame.times.submitted_ns, due), after(frame.times.gpu_done_ns, due),
            after(frame.times.predicted_display_ns, due), after(frame.times.actual_display_ns, due),
            frame.late ? 1 : 0, particles_text(facts.particles_by_level),
            part(facts.tolerance, &FrameTolerance::active_fraction),
            part(facts.tolerance, &FrameTolerance::tau_fps), part(facts.tolerance, &FrameTolerance::beta),
            part(facts.tolerance, &FrameTolerance::mu_fps), part(facts.tolerance, &FrameTolerance::delta_fps),
            part(facts.guards, &FrameGuards::speed_limited),
            part(facts.guards, &FrameGuards::coincident_pairs), part(facts.guards, &FrameGuards::not_finite),
            part(facts.guards, &FrameGuards::neighbours_dropped),
            part(facts.guards, &FrameGuards::wall_projected), part(facts.guards, &FrameGuards::nozzle_waited),
            part(facts.guards, &FrameGuards::saliency_not_finite),
            part(facts.guards, &FrameGuards::gaze_lost))
        .run();
  }
}

void Store::add_frames(std::int64_t presentation, std::int64_t start_ns,
                       std::span<const FrameRecord> frames) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  commit(transaction);
}

}  // namespace study
