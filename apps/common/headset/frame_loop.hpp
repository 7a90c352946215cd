#pragma once
/// The slots of a headset, one after the other, whatever the program does meanwhile.

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/common/headset/headset_session.hpp"
#include "apps/common/headset/picture_turns.hpp"
#include "apps/common/headset/session_facts.hpp"
#include "apps/common/headset/session_maker.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libstudy/display/cut_cause.hpp"

namespace apps {

/// Who turns the slots. Caller: whoever asks for the next one, for runtimes whose time stands still
/// meanwhile. Thread: one that does nothing else, so that none is missed while the program computes, writes
/// and waits.
enum class SlotDrive { Caller, Thread };

/// What a picture was drawn from.
struct HeldViews {
  EyeViews views;
  bool in_head = false;  ///< see HeadsetLayers
};

/// What a slot brought in.
struct HeadsetRecord {
  HeadsetSlot slot;
  EyeViews views;  ///< where the eyes will be at slot.predicted_ns
  HeadsetInput input;
  int world = 0;                     ///< of its poses: another one where the origin moved
  std::optional<HeldViews> shown{};  ///< the picture that is on; none: black
};

/// How the session stood when its last slot was over.
struct LoopFacts {
  HeadsetState state = HeadsetState::Unknown;
  HeadsetRate rate;
  bool trusted = false;  ///< times convert, go forward and keep to their grid
  int world = 0;         ///< counts the moves of its origin
  HeadsetSlot last;
  EyeViews views;  ///< of the last slot
};

/// What is seen at the moment.
struct SeenNow {
  HeadsetLayers layers;  ///< as the last slot showed them
  EyeViews eyes;         ///< where the eyes were then
};

/// Owns the session. Its pictures are drawn on the thread that made the loop, where its context is current;
/// all calls but those of an onlooker come from there. They throw what went wrong with the session:
/// base::Error, HeadsetLost.
///
/// A session that the runtime loses is made anew, as SessionMaker has it: events tell so, and no slots come
/// meanwhile. What is on when it is lost, or when the world's origin moves, gives way to black until
/// something else is shown.
class FrameLoop {
 public:
  /// Of records that nobody takes; a minute's and more.
  static constexpr std::size_t most_records = 20000;

  /// Connects.
  FrameLoop(const HeadsetChoice& choice, SlotDrive drive);
  ~FrameLoop();
  FrameLoop(const FrameLoop&) = delete;
  FrameLoop& operator=(const FrameLoop&) = delete;

  /// The newest one's.
  SessionFacts session() const;
  LoopFacts facts() const;
  /// When what is posted now would be seen: the next slot, on the session's clock. While no slots come it
  /// goes on with the system's clock.
  std::int64_t next_ns() const;
  /// The same, and going on between two slots with the system's clock where a thread turns them.
  std::int64_t now_ns() const;
  /// Turns a slot; with a thread, waits for one, or a tenth of a second where none comes.
  void turn();
  /// Of the display, ns; 0 before any slot.
  std::int64_t period_ns() const;
  /// Where the eyes will be, on the session's clock; in the world, or in the head's own space. Not valid
  /// while no slots come for want of a session.
  EyeViews views_at(std::int64_t at_ns);
  EyeViews views_in_head(std::int64_t at_ns);

  /// To draw both eyes' picture into, as HeadsetLayers has it; ask again for each picture.
  const sim::Offscreen& canvas();
  /// Shows the canvas as it was drawn, from the slot that is the nearest to due_ns or the next one after
  /// that, until another picture is shown or clear(). Waits until it is on; returns its slot.
  HeadsetSlot show(const HeldViews& from, std::int64_t due_ns);
  void clear();
  /// The same of the page.
  const sim::Offscreen& page();
  void show_page(const HeadsetPage& place);
  void hide_page();

  /// What happened, and what the slots that are over brought in, since the last call; of records that nobody
  /// takes the oldest go.
  std::vector<HeadsetEvent> take_events();
  std::vector<HeadsetRecord> take_records();
  /// Why, since the last call, a slot in which a picture was on could not be seen; none: all were.
  std::optional<study::CutCause> take_unseen();

  /// For one who looks on from another thread: a context that shares the pictures, current nowhere.
  sim::GlContext admit_onlooker();
  /// The onlooker's. Its pictures stay as they are until the next call or look_away().
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
  void black_out(study::CutCause cause);
  using AskViews = EyeViews (HeadsetSession::*)(std::int64_t);
  EyeViews ask_views(AskViews ask, std::int64_t at_ns);
  float light_at(std::int64_t at_ns) const;

  sim::GlContext gl_;
  std::optional<sim::GlContext> slots_gl_;  ///< of the thread; shares objects with gl_
  SlotDrive drive_;
  std::optional<SessionMaker> maker_;
  std::mutex asking_;  ///< of session_, where another thread asks: taken before mutex_, and to replace it
  std::unique_ptr<HeadsetSession> session_;  ///< none: it was lost, and the next one is being made
  PictureSize page_size_;                    ///< 0: no pages
  std::vector<std::unique_ptr<sim::Offscreen>> canvases_, pages_;  ///< as PictureTurns counts them
  bool onlooker_ = false;

  mutable std::mutex mutex_;  ///< for everything below
  std::condition_variable changed_;
  PictureTurns picture_turns_, page_turns_;
  HeldViews shown_from_, waiting_from_;
  HeadsetPage shown_place_, waiting_place_;
  std::int64_t due_ns_ = 0;                ///< of the picture that waits
  HeadsetSlot came_on_;                    ///< of the picture that is shown
  std::optional<study::CutCause> unseen_;  ///< why a picture that was on was not seen
  bool running_ = false, stopping_ = false;
  bool doubted_ = false;       ///< times repeated or left their grid
  bool runtime_ends_ = false;  ///< no session can be made anew
  SessionFacts told_;
  std::vector<std::int64_t> moves_ns_;  ///< when the world's origin will move
  LoopFacts facts_;
  std::int64_t slots_ = 0;           ///< that were begun
  std::int64_t last_system_ns_ = 0;  ///< when the last of them was
  std::vector<HeadsetEvent> events_;
  std::vector<HeadsetRecord> records_;
  std::exception_ptr error_;  ///< of the thread
  std::thread thread_;
};

}  // namespace apps
