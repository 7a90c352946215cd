#pragma once
/// Runs the slots (frames) of a headset one after the other, on the caller's thread or on a separate thread.

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
#include "libstudy/headset/flash_guard.hpp"
#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/picture_turns.hpp"
#include "libstudy/headset/session_maker.hpp"

namespace study {

/// The thread that runs the slots (frames of the runtime). Caller: the thread that calls FrameLoop::turn(),
/// for runtimes whose time stops between slots. Thread: a separate thread that does nothing else, so that no
/// slot is missed while the program computes, writes or waits.
enum class SlotDrive { Caller, Thread };

/// The eye views that a picture was drawn from.
struct HeldViews {
  EyeViews views;
  bool in_head = false;  ///< true: poses in the head's frame; false: in the world
};

/// The record of one slot.
struct HeadsetRecord {
  HeadsetSlot slot;
  EyeViews views;  ///< predicted poses of the eyes at slot.predicted_ns
  HeadsetInput input;
  /// Changes whenever the poses' origin may have moved: at a recentring, after lost events, and with a new
  /// session.
  int world = 0;
  std::optional<HeldViews> shown{};  ///< eye views of the shown picture; none: no picture
};

/// The session's state as of its last slot.
struct LoopFacts {
  HeadsetState state = HeadsetState::Unknown;
  HeadsetRate rate;
  /// True: the slots' predicted times convert to the session's clock, and so far every step between two
  /// predicted times of this session was positive and within a tenth of a period of a whole number of
  /// periods. Steps during a change of the refresh rate do not count once the change is detected.
  bool trusted = false;
  int world = 0;     ///< changes whenever the poses' origin may have moved; as HeadsetRecord::world
  bool worn = true;  ///< false: the runtime reported that nobody wears the headset
  HeadsetSlot last;
  EyeViews views;  ///< predicted poses of the eyes in the last slot
};

/// The view of the participant in the last slot, for an onlooker.
struct SeenNow {
  HeadsetLayers layers;  ///< picture and page that the last slot showed
  EyeViews eyes;         ///< poses of the eyes in the last slot
};

/// Owns the session and runs its slots. The loop's OpenGL context is current on the thread that made the
/// loop. Draw pictures on this thread, and make all calls on it, except look() and look_away(). Calls throw
/// the session's errors: base::Error, HeadsetLost.
///
/// If the runtime loses the session, SessionMaker makes a new session. Events report the loss and the new
/// session; no slots come in between. When the session is lost or the world's origin moves, picture and page
/// disappear, and the slots are black until another picture or page is shown. Slots are also black where
/// pictures and pages would flash (FlashGuard).
class FrameLoop {
 public:
  /// Largest number of stored records, enough for the slots of more than a minute.
  static constexpr std::size_t most_records = 20000;

  /// Connects to the headset.
  FrameLoop(const HeadsetChoice& choice, SlotDrive drive);
  ~FrameLoop();
  FrameLoop(const FrameLoop&) = delete;
  FrameLoop& operator=(const FrameLoop&) = delete;

  /// Facts of the newest session.
  SessionFacts session() const;
  LoopFacts facts() const;
  /// The predicted time of the next slot on the session's clock, in which a picture posted now would be
  /// shown. If a thread runs the slots and no slots come, the time advances with the system's clock.
  std::int64_t next_ns() const;
  /// As next_ns(). If a thread runs the slots, the time also advances with the system's clock between two
  /// slots.
  std::int64_t now_ns() const;
  /// SlotDrive::Caller: runs a slot, or returns without a slot if an event waits for take_events();
  /// base::Error if no slot runs for 30 s. SlotDrive::Thread: waits for the next slot, 0.1 s at most.
  void turn();
  /// Refresh period of the display, ns; 0 before any slot.
  std::int64_t period_ns() const;
  /// Predicted poses of the eyes at a time of the session's clock, in the world or (views_in_head) in the
  /// head's frame. Not valid before the first slot, or while there is no session.
  EyeViews views_at(std::int64_t at_ns);
  EyeViews views_in_head(std::int64_t at_ns);

  /// The canvas to draw the next picture of both eyes into, side by side as in HeadsetLayers. Call it for
  /// each picture.
  const sim::Offscreen& canvas();
  /// Shows the canvas from the slot nearest to due_ns, or from the next slot if that one is over, until
  /// another picture is shown or clear() is called; after 2 s the picture fades to black. Waits until the
  /// picture is shown and returns its first slot. If the picture cannot be shown, returns a slot with
  /// predicted_ns = due_ns, and take_unseen() returns the cause.
  HeadsetSlot show(const HeldViews& from, std::int64_t due_ns);
  void clear();
  /// page() and show_page() do for the page what canvas() and show() do for the picture, but do not wait.
  /// hide_page() removes the page.
  const sim::Offscreen& page();
  void show_page(const HeadsetPage& place);
  void hide_page();

  /// Events, or records of slots, since the last call. When most_records records are stored, the oldest half
  /// of them is dropped.
  std::vector<HeadsetEvent> take_events();
  std::vector<HeadsetRecord> take_records();
  /// Why a picture could not be seen in some slot since the last call; none if all pictures could be seen.
  std::optional<CutCause> take_unseen();

  /// Makes an OpenGL context for an onlooker (a mirror) on another thread. The context shares the pictures
  /// and is not current.
  sim::GlContext admit_onlooker();
  /// The shown picture and page, for the onlooker. They stay unchanged until the next look() or look_away().
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

  sim::GlContext gl_;
  std::optional<sim::GlContext> slots_gl_;  ///< context of the slot thread; shares objects with gl_
  SlotDrive drive_;
  std::optional<SessionMaker> maker_;
  std::mutex asking_;                        ///< guards session_ against other threads; lock it before mutex_
  std::unique_ptr<HeadsetSession> session_;  ///< null: the session is lost, a new one is being made
  base::PictureSize page_size_;              ///< 0: no pages
  std::vector<std::unique_ptr<sim::Offscreen>> canvases_, pages_;  ///< indexed by PictureTurns
  bool onlooker_ = false;

  mutable std::mutex mutex_;  ///< guards the members below, except thread_
  std::condition_variable changed_;
  PictureTurns picture_turns_, page_turns_;
  HeldViews shown_from_, waiting_from_;
  HeadsetPage shown_place_, waiting_place_;
  std::int64_t due_ns_ = 0;  ///< due time of the waiting picture
  HeadsetSlot came_on_;      ///< first slot of the shown picture
  FlashGuard flashes_;
  std::optional<CutCause> unseen_;  ///< why a shown picture could not be seen
  bool running_ = false, stopping_ = false;
  bool runtime_ends_ = false;  ///< the runtime shuts down: no new session is possible
  SessionFacts reported_;
  std::vector<std::int64_t> moves_ns_;  ///< times at which the world's origin will move
  LoopFacts facts_;
  std::int64_t slots_ = 0;           ///< number of slots begun
  std::int64_t last_system_ns_ = 0;  ///< time at which the last slot was recorded, on the system's clock
  std::vector<HeadsetEvent> events_;
  std::vector<HeadsetRecord> records_;
  std::exception_ptr error_;  ///< error that ended the slot thread
  std::thread thread_;
};

}  // namespace study
