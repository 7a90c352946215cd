#pragma once
/// The slots of a headset, one after the other, whatever the program does meanwhile.

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "apps/common/headset/headset_session.hpp"
#include "apps/common/headset/picture_turns.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

/// Who turns the slots. Caller: whoever asks for the next one, for runtimes whose time stands still
/// meanwhile. Thread: one that does nothing else, so that none is missed while the program computes, writes
/// and waits.
enum class SlotDrive { Caller, Thread };

/// What a slot brought in.
struct HeadsetRecord {
  HeadsetSlot slot;
  EyeViews views;  ///< where the eyes will be at slot.predicted_ns
  HeadsetInput input;
};

/// What a picture was drawn from.
struct HeldViews {
  EyeViews views;
  bool in_head = false;  ///< see HeadsetLayers
};

/// How the session stood when its last slot was over.
struct LoopFacts {
  HeadsetState state = HeadsetState::Unknown;
  HeadsetRate rate;
  bool trusted = false;  ///< times convert, go forward and keep to their grid
  HeadsetSlot last;
};

/// What is seen at the moment.
struct SeenNow {
  HeadsetLayers layers;  ///< as the last slot showed them
  EyeViews eyes;         ///< where the eyes were then
};

/// Owns the session. Its pictures are drawn on the thread that made the loop, where its context is current;
/// all calls but those of an onlooker come from there. They throw what went wrong with the session:
/// base::Error, HeadsetLost.
class FrameLoop {
 public:
  /// Of records that nobody takes; a minute's and more.
  static constexpr std::size_t most_records = 20000;

  /// Connects.
  FrameLoop(const HeadsetChoice& choice, SlotDrive drive);
  ~FrameLoop();
  FrameLoop(const FrameLoop&) = delete;
  FrameLoop& operator=(const FrameLoop&) = delete;

  /// For what does not change while it lives.
  const HeadsetSession& session() const { return *session_; }
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
  /// Where the eyes will be, on the session's clock; in the world, or in the head's own space.
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
  /// Whether, since the last call, a slot in which a picture was on could not be seen.
  bool take_unseen();

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
  void run(const HeadsetChoice& choice);
  void draw_slots();
  bool turn_slot();
  HeadsetLayers take_in(const HeadsetRecord& record);
  float light_at(std::int64_t at_ns) const;
  std::int64_t runtime_time_of(std::int64_t at_ns) const;

  sim::GlContext gl_;
  std::optional<sim::GlContext> slots_gl_;  ///< of the thread; shares objects with gl_
  SlotDrive drive_;
  std::unique_ptr<HeadsetSession> session_;
  std::string go_on_;                                              ///< HeadsetChoice's
  PictureSize page_size_;                                          ///< 0: no pages
  std::vector<std::unique_ptr<sim::Offscreen>> canvases_, pages_;  ///< as PictureTurns counts them
  bool onlooker_ = false;

  mutable std::mutex mutex_;  ///< for everything below
  std::condition_variable changed_;
  PictureTurns picture_turns_, page_turns_;
  HeldViews shown_from_, waiting_from_;
  HeadsetPage shown_place_, waiting_place_;
  std::int64_t due_ns_ = 0;  ///< of the picture that waits
  HeadsetSlot came_on_;      ///< of the picture that is shown
  EyeViews eyes_;            ///< in the last slot
  bool unseen_ = false, running_ = false, stopping_ = false;
  LoopFacts facts_;
  std::int64_t slots_ = 0;           ///< that were begun
  std::int64_t last_system_ns_ = 0;  ///< when the last of them was
  std::vector<HeadsetEvent> events_;
  std::vector<HeadsetRecord> records_;
  std::exception_ptr error_;  ///< of the thread
  std::thread thread_;
};

}  // namespace apps
