#pragma once
/// Runs the slots of a headset one after the other, independently of the rest of the program.

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/display/cut_cause.hpp"
#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/picture_turns.hpp"
#include "libstudy/headset/session_maker.hpp"

namespace study {

/// Who runs the slots. Caller: the code that asks for the next one, for runtimes whose time stops in between.
/// Thread: a thread that does nothing else, so that no slot is missed while the program computes, writes and
/// waits.
enum class SlotDrive { Caller, Thread };

/// The eye views that a picture was drawn from.
struct HeldViews {
  EyeViews views;
  bool in_head = false;  ///< see HeadsetLayers
};

/// What one slot delivered.
struct HeadsetRecord {
  HeadsetSlot slot;
  EyeViews views;  ///< where the eyes will be at slot.predicted_ns
  HeadsetInput input;
  int world = 0;                     ///< number of the world of its poses; changes when the origin moves
  std::optional<HeldViews> shown{};  ///< the picture on show; none: black
};

/// The session's state at the end of its last slot.
struct LoopFacts {
  HeadsetState state = HeadsetState::Unknown;
  HeadsetRate rate;
  bool trusted = false;  ///< times convert, go forward and stay on their grid
  int world = 0;         ///< number of moves of the world's origin
  HeadsetSlot last;
  EyeViews views;  ///< of the last slot
};

/// What is seen at the moment.
struct SeenNow {
  HeadsetLayers layers;  ///< as the last slot showed them
  EyeViews eyes;         ///< where the eyes were then
};

/// Owns the session. Draw its pictures on the thread that made the loop, where its context is current; all
/// calls except the onlooker's come from that thread. They throw the session's errors: base::Error,
/// HeadsetLost.
///
/// If the runtime loses the session, SessionMaker makes a new one: events report this, and no slots come in
/// between. When the session is lost or the world's origin moves, the picture on show turns black until
/// another one is shown.
class FrameLoop {
 public:
  /// Limit of records that were not taken; more than a minute's worth.
  static constexpr std::size_t most_records = 20000;

  /// Connects to the headset.
  FrameLoop(const HeadsetChoice& choice, SlotDrive drive);
  ~FrameLoop();
  FrameLoop(const FrameLoop&) = delete;
  FrameLoop& operator=(const FrameLoop&) = delete;

  /// Facts of the newest session.
  SessionFacts session() const;
  LoopFacts facts() const;
  /// When a picture posted now would be seen: the next slot's time on the session's clock. If a thread runs
  /// the slots and none come, it advances with the system's clock.
  std::int64_t next_ns() const;
  /// The same; if a thread runs the slots, it also advances with the system's clock between two slots.
  std::int64_t now_ns() const;
  /// Runs a slot; with a thread, waits for one, a tenth of a second at most.
  void turn();
  /// Refresh period of the display, ns; 0 before any slot.
  std::int64_t period_ns() const;
  /// Where the eyes will be, at a time of the session's clock; in the world, or in the head's own space. Not
  /// valid while there is no session.
  EyeViews views_at(std::int64_t at_ns);
  EyeViews views_in_head(std::int64_t at_ns);

  /// The canvas for both eyes' picture, arranged as in HeadsetLayers; call it again for each picture.
  const sim::Offscreen& canvas();
  /// Shows the canvas from the slot nearest to due_ns, or the next slot after that, until another picture is
  /// shown or clear() is called. Waits until the picture is on; returns its slot.
  HeadsetSlot show(const HeldViews& from, std::int64_t due_ns);
  void clear();
  /// The same for the page.
  const sim::Offscreen& page();
  void show_page(const HeadsetPage& place);
  void hide_page();

  /// Events, and records of finished slots, since the last call; too many records drop the oldest.
  std::vector<HeadsetEvent> take_events();
  std::vector<HeadsetRecord> take_records();
  /// Why a slot with a picture could not be seen since the last call; none if all were seen.
  std::optional<CutCause> take_unseen();

  /// Makes a context for an onlooker on another thread; it shares the pictures and is not current.
  sim::GlContext admit_onlooker();
  /// For the onlooker. The pictures stay unchanged until its next call or look_away().
  SeenNow look();
  void look_away();

 private:
  void make_pictures(std::size_t count);
  HeadsetLayers layers_at(std::int64_t at_ns, std::size_t picture, std::size_t page) const;
  bool others_read() const { return drive_ == SlotDrive::Thread || onlooker_; }
  void stop();
  void make_session();
  void make_anew();
  void run();
  void draw_slots();
  bool turn_slot();
  bool poll();
  HeadsetLayers take_in(HeadsetRecord record);
  void follow_world(std::int64_t predicted_ns);
  void black_out(CutCause cause);
  using AskViews = EyeViews (HeadsetSession::*)(std::int64_t);
  EyeViews ask_views(AskViews ask, std::int64_t at_ns);
  float light_at(std::int64_t at_ns) const;

  sim::GlContext gl_;
  std::optional<sim::GlContext> slots_gl_;  ///< of the thread; shares objects with gl_
  SlotDrive drive_;
  std::optional<SessionMaker> maker_;
  std::mutex asking_;                        ///< guards session_ against other threads; lock it before mutex_
  std::unique_ptr<HeadsetSession> session_;  ///< null: it was lost, and the next one is being made
  base::PictureSize page_size_;              ///< 0: no pages
  std::vector<std::unique_ptr<sim::Offscreen>> canvases_, pages_;  ///< indexed by PictureTurns
  bool onlooker_ = false;

  mutable std::mutex mutex_;  ///< guards everything below
  std::condition_variable changed_;
  PictureTurns picture_turns_, page_turns_;
  HeldViews shown_from_, waiting_from_;
  HeadsetPage shown_place_, waiting_place_;
  std::int64_t due_ns_ = 0;         ///< of the waiting picture
  HeadsetSlot came_on_;             ///< slot in which the shown picture came on
  std::optional<CutCause> unseen_;  ///< why a picture that was on was not seen
  bool running_ = false, stopping_ = false;
  bool doubted_ = false;       ///< times repeated or left their grid
  bool runtime_ends_ = false;  ///< no session can be made anew
  SessionFacts reported_;
  std::vector<std::int64_t> moves_ns_;  ///< times at which the world's origin will move
  LoopFacts facts_;
  std::int64_t slots_ = 0;           ///< number of slots begun
  std::int64_t last_system_ns_ = 0;  ///< when the last slot began, on the system's clock
  std::vector<HeadsetEvent> events_;
  std::vector<HeadsetRecord> records_;
  std::exception_ptr error_;  ///< thrown on the thread
  std::thread thread_;
};

}  // namespace study
