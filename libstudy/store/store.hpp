#pragma once
/// Writes a study's database during sessions: first the whole plan, then one commit per answer. All failures
/// are base::Error and name the file; what was committed before stays.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/design/station.hpp"
#include "libstudy/display/gaze.hpp"
#include "libstudy/display/headset.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/file/writer_lock.hpp"

namespace study {

class AnswerJournal;

/// base::Error unless a new participant code is 1 to 32 of A-Z a-z 0-9 _ and - and begins with a letter or
/// digit, so that it is never read as an option or a formula. Earlier databases may hold other codes.
void check_participant_code(const std::string& code);

/// How a session's display frames a scene, for cells with equal framing.
struct SceneFraming {
  std::string scene;                            ///< scene file as the protocol names it
  int width_px = 0, height_px = 0;              ///< of the picture as it is drawn
  int shown_width_px = 0, shown_height_px = 0;  ///< on the display; differs for scaled pictures of a bake
  double camera_angle_deg = 0;                  ///< vertical, in (0, 180)
  std::optional<double> visual_angle_deg;  ///< angle that the picture subtends at the eye; none: not known
  std::vector<int> cells;                  ///< of the protocol's design
  std::vector<int>
      copied;            ///< of these, the cells whose pictures come from a bake; the others are drawn live
  std::string renderer;  ///< that draws or drew the pictures; empty: not known
};

/// Facts of a session that are written before its first unit.
struct SessionPlan {
  std::string participant;
  int visit = 1;
  std::uint64_t seed = 0;  ///< at most 2^63 - 1
  bool test_data = false;
  std::optional<std::string> observer;  ///< simulated observer; none = a person
  bool virtual_clock = false;
  std::string display, stimulus, machine, time_zone;
  std::optional<std::string> ptpe;              ///< the PTPE file in full
  std::string gaze_source = "none";             ///< "tracked", "head", "mouse", "fixed", "fixation" or "none"
  std::string station;                          ///< where it is recorded
  std::optional<StationNumber> station_number;  ///< not read back: slot and seed follow from it
  std::optional<double> screen_width_mm, viewing_distance_mm;
  std::optional<double> refresh_hz;   ///< of the display; none: frames are shown as they come
  std::vector<SceneFraming> framing;  ///< not read back; empty: nothing is drawn
  Plan plan;
};

/// A run, one command for one or more participants, as it is stored.
struct RunPlan {
  Protocol protocol;
  std::string options;  ///< text from which the program restores the run's options
  std::vector<SessionPlan> sessions;
};

/// A unit that is not done yet.
struct OpenUnit {
  std::int64_t id = 0;
  PlannedUnit plan;
  std::int64_t trial_id = 0;          ///< 0 for a page
  std::optional<PlannedTrial> trial;  ///< none for a page
  int attempts = 0;                   ///< showings of the trial so far
  bool begun = false;                 ///< the trial was shown since it was last set aside, and was cut
  std::vector<std::string> answered;  ///< ids of answered questions: not asked again
};

/// A session with its open units, in the order of their positions.
struct OpenSession {
  std::int64_t id = 0;
  SessionPlan plan;  ///< without units and trials; the slot is set
  std::size_t planned = 0, done = 0;
  std::vector<OpenUnit> units;
};

/// Unfinished sessions of one run, with the run's options and protocol.
struct OpenRun {
  std::int64_t id = 0;
  std::string options;
  std::string protocol_name, protocol_text, protocol_sha256;
  std::optional<double> trial_seconds;
  std::vector<OpenSession> sessions;
};

/// How a session ended before its last unit.
enum class EarlyEnd {
  Refused,      ///< no consent
  NotEligible,  ///< ruled out by screening
  Stopped,      ///< by a stop rule or at the participant's request; the data stay
  DroppedOut    ///< did not come back; the slot is free again
};

struct Ending {
  EarlyEnd how = EarlyEnd::Stopped;
  std::string reason;  ///< may be empty
};

/// A headset slot and the frame shown in it; none: black.
struct ShownSlot {
  SlotRecord slot;
  std::optional<std::int64_t> frame;
};

/// The result of an eye tracker's validation at one target.
struct ValidatedPoint {
  std::int64_t clock_ns = 0;                  ///< when its samples began
  double azimuth_deg = 0, elevation_deg = 0;  ///< of the target
  std::int64_t samples = 0, valid = 0;        ///< all samples, and the valid ones
  std::optional<double> accuracy_deg;         ///< none: no valid sample
  std::optional<double> sd_deg, rms_s2s_deg;  ///< precision; none: too few samples
};

/// An answer to be stored.
struct KeptAnswer {
  std::string question;  ///< id
  TimedAnswer answer;
};

/// The only writer of a database: a second Store on the same file is an error while the first exists. Calls
/// that commit may come from any thread; they take turns.
class Store {
 public:
  /// Open::Create or Open::Write. max_pages > 0 limits the file's size to that many pages. A file made here
  /// is removed again if nothing is stored in it. First does the chores left over (chores.hpp) and the
  /// requested withdrawals (withdraw.hpp). waiting: for locks of other programs; five seconds without it.
  Store(const std::filesystem::path& path, sqlite::Open how, std::int64_t max_pages = 0,
        const sqlite::Waiting& waiting = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// Clean-ups that failed, each with reason and remedy: a session may go on, but the command should fail.
  std::vector<std::string> left_to_clean() const { return left_; }

  /// Sets the receiver of one-line warnings if the journal of answers cannot be written or was lost; default:
  /// stderr.
  void tell_of_journal(const std::function<void(const std::string&)>& tell);
  /// Call at the end of a command: base::Error if the journal still lacks committed rows.
  void require_journal();

  /// Writes protocol, sessions and every trial of every session in one transaction; returns the run's id.
  /// base::Error if a participant already has that visit under that protocol, or a code that differs from
  /// another only in case, or if the protocol's name and version are stored with another text.
  std::int64_t add_run(const RunPlan& run);

  /// Stores how the display of a resumed session frames its scenes, if that changed. Later presentations
  /// refer to the new framing.
  void add_framing(std::int64_t session, const std::vector<SceneFraming>& framing);
  /// Stores the facts of a session's headset unless equal facts are stored already.
  void add_headset(std::int64_t session, const HeadsetFacts& headset);
  /// Stores the distance between the eyes from now on, mm, if it differs by more than 0.2 mm from the last
  /// one.
  void add_ipd(std::int64_t session, std::int64_t clock_ns, double ipd_mm);

  /// The latest time stored in the database, by any clock; empty if there is none.
  std::string newest_utc();

  /// The open runs. First marks presentations that an earlier process left running as interrupted.
  std::vector<OpenRun> open_runs();

  /// Slots of the sessions under this protocol that count for the balance: all but those that were withdrawn,
  /// refused, not eligible or dropped out, and test data beside real ones.
  std::vector<int> taken_slots(const std::string& protocol_sha256);
  /// Returns each station number of the sessions that taken_slots() counts, once. An empty entry means that
  /// some of these sessions have no station number.
  std::vector<std::optional<StationNumber>> station_numbers(const std::string& protocol_sha256);

  /// Commits that a stimulus is about to be shown; returns the presentation's id. gaze_source: the gaze that
  /// the fluid follows; none: as planned for the session.
  std::int64_t begin_presentation(std::int64_t session, std::int64_t trial, int attempt, int interval,
                                  int cell, std::int64_t start_ns,
                                  const std::optional<std::string>& gaze_source = {});
  /// Commits frames of a running presentation. Times are stored relative to start_ns and to the planned
  /// onset.
  void add_frames(std::int64_t presentation, std::int64_t start_ns, std::span<const FrameRecord> frames);
  /// Returns the participants who asked at the end of a session that all their data be deleted. Close this
  /// Store, then call withdraw() for each of them.
  std::vector<std::string> requested_withdrawals();
  /// True if this session has any presentation, or any answer.
  bool has_shown(std::int64_t session);
  bool has_answers(std::int64_t session);
  /// True if the participant currently allows recording gaze in this session.
  bool allows_gaze(std::int64_t session);
  /// Commits samples of a presentation, appended to its former ones. base::Error, with nothing stored, unless
  /// the participant allows recording gaze.
  void add_gaze(std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
                std::span<const GazeSample> samples);
  /// Commits slots of a presentation, appended to its former ones. base::Error, with nothing stored, for a
  /// head pose unless the participant allows recording gaze.
  void add_slots(std::int64_t presentation, std::int64_t start_ns, std::span<const ShownSlot> slots);
  /// Commits a validation of the eye tracker, appended to the session's former ones. base::Error as
  /// add_gaze().
  void add_validation(std::int64_t session, std::span<const ValidatedPoint> points, bool passed);
  /// Commits the rest of the frames and the verdict. Without a schedule (nominal mean 0) the verdict is
  /// stored only for a cut trial.
  void end_presentation(std::int64_t presentation, std::int64_t start_ns, std::int64_t end_ns,
                        std::span<const FrameRecord> frames, const TimingVerdict& verdict);
  /// Commits that a presentation was cut short, and why; its frames stay.
  void interrupt_presentation(std::int64_t session, std::int64_t presentation, const std::string& why,
                              std::int64_t clock_ns);
  /// Commits the answers of one page in one transaction. attempt: showing of the trial that was judged; 0:
  /// not a trial. `last`: the unit is then done, and with its last unit the session, unless the trial was set
  /// aside since that showing. An `ending` caused by the answers is stored with them. Permissions in them
  /// hold from then on. base::Error, with nothing stored, for a question that is personal, unknown or already
  /// answered here.
  void answer(std::int64_t session, const OpenUnit& unit, int attempt, std::span<const KeptAnswer> answers,
              bool last, std::int64_t clock_ns, const std::optional<Ending>& ending = {});
  /// Commits that a unit without answers is done.
  void finish_unit(std::int64_t session, std::int64_t unit, std::int64_t clock_ns);
  /// Ends a session before its last unit; open units stay planned. The reason becomes a note.
  void end_session(std::int64_t session, const Ending& ending, std::int64_t clock_ns);
  /// Reopens a trial, done or under way: it is shown once more as a new attempt, and its former answers are
  /// set aside. The reason becomes a note.
  void repeat_trial(std::int64_t session, std::int64_t trial, const std::string& reason);
  /// Reopens every trial of a block that is done or under way, as repeat_trial does, in one transaction.
  void restart_block(std::int64_t session, int block, const std::string& reason);
  /// Excludes a begun trial instead of showing it again: its unit is done, its answers stay.
  void leave_out_trial(std::int64_t session, const OpenUnit& unit, const std::string& reason);
  /// Marks a trial as excluded from analyses.
  void exclude_trial(std::int64_t session, std::int64_t trial, const std::string& reason);
  /// Stores a note of the experimenter, apart from the log; withdrawal deletes it.
  void note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words);
  /// Appends to the event log. `detail` never holds answers or free text of participants.
  void log(std::optional<std::int64_t> session, const std::string& kind, const std::string& detail,
           std::optional<std::int64_t> clock_ns = {});

 private:
  struct Statements;

  /// A copy of a database that another program has locked. Its changes go only into the journal; the next
  /// opening of the database takes them over.
  explicit Store(Store& locked);
  /// Makes a change that cannot be repeated: an answer or a note. If the file is locked, makes it in
  /// copy_ and then throws LockedOut.
  void make(const std::function<void(Store&)>& change);
  void write_answers(std::int64_t session, const OpenUnit& unit, int attempt,
                     std::span<const KeptAnswer> answers, bool last, std::int64_t clock_ns,
                     const std::optional<Ending>& ending);
  void write_note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words);
  /// Ends every change: writes it to the journal, then to the database.
  void commit(sqlite::Transaction& transaction);
  std::int64_t find_or_add_protocol(const RunPlan& run);
  void add_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                   const SessionPlan& plan, const std::string& not_before_utc);
  void check_newcomer(std::int64_t protocol_id, const SessionPlan& plan);
  void mark_cut_presentations();
  void mark_done(std::int64_t session, std::int64_t unit, const std::string& now,
                 std::optional<std::int64_t> clock_ns);
  [[noreturn]] void throw_no_trial() const;
  void mark_ended(std::int64_t session, const Ending& ending, std::int64_t clock_ns);
  void mark_excluded(std::int64_t session, std::int64_t trial, const std::string& reason);
  void set_trial_aside(std::int64_t session, std::int64_t trial);
  void require_gaze_allowed(std::int64_t session);
  std::int64_t session_of(std::int64_t presentation);
  void answer_over_change(std::int64_t session, const std::string& question, const std::string& now);
  bool set_aside(const OpenUnit& unit, int attempt);
  std::int64_t trial_unit(std::int64_t trial);
  void insert_note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words);
  void insert_frames(std::int64_t presentation, std::int64_t start_ns, std::span<const FrameRecord> frames);
  void insert_event(std::optional<std::int64_t> session, std::optional<std::int64_t> presentation,
                    const std::string& kind, const std::string& detail, std::optional<std::int64_t> clock_ns);

  void keep_file();

  std::filesystem::path path_;
  std::optional<WriterLock> lock_;  ///< none for a copy
  std::unique_ptr<sqlite::Connection> database_;
  std::unique_ptr<Statements> statements_;
  std::unique_ptr<AnswerJournal> journal_;
  std::mutex copying_;                  ///< guards copy_: the console writes notes from its own thread
  std::unique_ptr<Store> copy_;         ///< see make()
  std::atomic<bool> given_up_ = false;  ///< copy_ exists: nothing more goes into the file
  std::vector<std::string> left_;
};

}  // namespace study
