#pragma once
/// Writes a study's database during sessions: first the whole plan, then each page of answers in a commit of
/// its own. Failures of the database are base::Error and name the file; earlier commits stay in the database.

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

#include "libstudy/design/adaptive_track.hpp"
#include "libstudy/design/plan.hpp"
#include "libstudy/design/station.hpp"
#include "libstudy/display/gaze.hpp"
#include "libstudy/display/headset.hpp"
#include "libstudy/markers/marker.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/imported.hpp"

namespace study {

struct LightEvidence;  // light_evidence.hpp
struct ReservedSlot;   // reserved_slots.hpp
struct SlotRequest;    // reserved_slots.hpp

class AnswerJournal;

/// base::Error unless a new participant code has 1 to 32 of the characters A-Z a-z 0-9 _ and - and begins
/// with a letter or digit. So no code reads as a command-line option or a formula. Databases of earlier
/// versions may contain other codes.
void check_participant_code(const std::string& code);

/// Picture sizes, angles and renderer with which a session's display shows a scene. Cells that agree in all
/// of these share a SceneFraming.
struct SceneFraming {
  std::string scene;                            ///< scene file as the protocol names it
  int width_px = 0, height_px = 0;              ///< size of the picture as it is drawn
  int shown_width_px = 0, shown_height_px = 0;  ///< size on the display; a bake's picture may be scaled
  double camera_angle_deg = 0;                  ///< vertical field of view of the camera, in (0, 180)
  std::optional<double> visual_angle_deg;       ///< vertical visual angle of the picture; none: not known
  std::vector<int> cells;                       ///< cells with this framing, indices into Design::cells
  std::vector<int> copied;  ///< cells whose pictures come from a bake; the session draws the others
  std::string renderer;     ///< renderer that draws or drew the pictures; empty: not known
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
  std::optional<std::string> ptpe;  ///< full text of the PTPE file; none: the paper's model
  /// "tracked", "head", "mouse", "fixed" (assumed in the middle of the picture), "fixation" (the protocol
  /// makes people look at the middle) or "none"
  std::string gaze_source = "none";
  std::string station;  ///< name of the station that records the session
  /// number of that station; open_runs() leaves it empty, because slot and seed already depend on it
  std::optional<StationNumber> station_number;
  std::optional<double> screen_width_mm, viewing_distance_mm;
  std::optional<double> refresh_hz;  ///< refresh rate of the display; none: frames are shown when ready
  std::string reservation;           ///< ReservedSlot::name() of its slot; empty: the station chose the slot
  /// framing of each scene; empty if nothing is drawn, and in plans that open_runs() returns
  std::vector<SceneFraming> framing;
  Plan plan;
};

/// The data of a new run for add_run(). A run is one vip-study command for one or more participants.
struct RunPlan {
  Protocol protocol;
  std::string options;  ///< text from which the program restores the run's options
  std::vector<SessionPlan> sessions;
};

/// A unit of a session (a trial or a page) that is not done yet.
struct OpenUnit {
  std::int64_t id = 0;
  PlannedUnit plan;
  std::int64_t trial_id = 0;          ///< row number of the trial; 0 for a page
  std::optional<PlannedTrial> trial;  ///< the trial as planned; none for a page
  int attempts = 0;                   ///< showings of the trial so far
  bool begun = false;  ///< a showing of the trial began since the trial was planned or last set aside
  std::vector<std::string> answered;  ///< ids of answered questions, which are not asked again
};

/// A session with its open units, in the order of their positions.
struct OpenSession {
  std::int64_t id = 0;
  SessionPlan plan;  ///< without the lists of units and trials; Plan::slot is set
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

/// Why a session ended before its last unit.
enum class EarlyEnd {
  Refused,      ///< the participant did not consent
  NotEligible,  ///< an answer on a screening or demographics page ruled the participant out
  Stopped,      ///< a stop rule, the participant or the experimenter ended the session
  DroppedOut    ///< the participant left (exception Left); another may get the same slot (Plan::slot)
};

struct Ending {
  EarlyEnd how = EarlyEnd::Stopped;
  std::string reason;  ///< words for a note; may be empty
};

/// A slot (display period) of a headset, with the index of the frame shown in it; none: the display was
/// black.
struct ShownSlot {
  SlotRecord slot;
  std::optional<std::int64_t> frame;
};

/// The result of an eye tracker's validation at one target.
struct ValidatedPoint {
  std::int64_t clock_ns = 0;                  ///< time at which the sampling at the target began
  double azimuth_deg = 0, elevation_deg = 0;  ///< direction of the target
  std::int64_t samples = 0, valid = 0;        ///< number of samples, and of valid samples
  std::optional<double> accuracy_deg;         ///< angle from target to mean gaze; none: no valid sample
  /// Precision: rms angle to the mean gaze, and rms angle from sample to sample; none: too few samples.
  std::optional<double> sd_deg, rms_s2s_deg;
};

/// An answer to be stored.
struct KeptAnswer {
  std::string question;  ///< id of the question in the protocol
  TimedAnswer answer;
};

/// The only writer of a database: a second Store on the same file is an error while the first exists.
/// Functions that commit may be called from any thread; a call waits until other threads have committed.
class Store {
 public:
  /// Opens the database. how: Open::Create or Open::Write. max_pages > 0 limits the file to that many pages
  /// of 4 KiB. waiting: decides how long to wait for locks of other programs (Connection::wait_with()); if
  /// empty, five seconds. First does the chores left over (chores.hpp) and the requested withdrawals
  /// (withdraw.hpp). The destructor removes a file that this Store made if nothing was stored in it.
  Store(const std::filesystem::path& path, sqlite::Open how, std::int64_t max_pages = 0,
        const sqlite::Waiting& waiting = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// Clean-ups that failed when the database was opened, each with reason and remedy. Sessions may continue,
  /// but the command should end with an error.
  std::vector<std::string> left_to_clean() const { return left_; }

  /// Sets the receiver of one-line warnings about a journal of answers that was lost or cannot be written.
  /// Default: stderr.
  void tell_of_journal(const std::function<void(const std::string&)>& tell);
  /// Call at the end of a command: base::Error if the journal of answers still lacks committed rows.
  void require_journal();

  /// Writes protocol, sessions and all their units and trials in one transaction; returns the run's id.
  /// base::Error if a participant already has this visit under this protocol, or withdrew. base::Error if a
  /// new code reads as a missing value, or differs from another code only in case, punctuation or leading
  /// zeros. base::Error if the protocol's name and version are stored with another text, unless one of the
  /// two protocols is test data.
  std::int64_t add_run(const RunPlan& run);

  /// Stores sessions that another program recorded, with their answers and frames, in one transaction. The
  /// protocol has one stimulus block and no pairs. base::Error, with nothing stored, as add_run(), and if the
  /// database holds a session of the same source or a participant with the same code.
  void add_import(const Protocol& protocol, const ImportTerms& terms,
                  const std::vector<ImportedSession>& sessions);

  /// Stores the framing of scenes on the display of a resumed session, if it changed. Later presentations
  /// refer to the new framing.
  void add_framing(std::int64_t session, const std::vector<SceneFraming>& framing);
  /// Stores the facts of a session's headset unless they equal the facts stored last for the session. The
  /// comparison ignores the fields of view and differences of the measured refresh rate below .5 %.
  void add_headset(std::int64_t session, const HeadsetFacts& headset);
  /// Stores the interpupillary distance from this time on, mm, if it differs by more than 0.2 mm from the
  /// last stored distance.
  void add_ipd(std::int64_t session, std::int64_t clock_ns, double ipd_mm);

  /// The latest UTC time of an event, a run's start or an answer in the database, from any computer's clock;
  /// empty if there is none.
  std::string newest_utc();

  /// The runs that have unfinished sessions. First marks as interrupted the presentations that an earlier
  /// process began and did not end.
  std::vector<OpenRun> open_runs();

  /// The slots (Plan::slot: positions in the counterbalancing) of this protocol's sessions, one entry each;
  /// the next participant gets a slot that is used least. Sessions that were withdrawn, refused, not eligible
  /// or dropped out do not count; neither do test sessions, unless the protocol is test data.
  std::vector<int> taken_slots(const std::string& protocol_sha256);
  /// The distinct station numbers ("2 of 5") of the sessions that taken_slots() counts. An empty entry means
  /// that some of these sessions have no station number.
  std::vector<std::optional<StationNumber>> station_numbers(const std::string& protocol_sha256);

  /// All slots that central databases were asked for, in the order of asking, then of their places.
  std::vector<ReservedSlot> reserved_slots();
  /// Commits a request for slots before it is sent; returns its token. So a request whose answer was lost is
  /// sent again with the same token, and gets the same slots.
  std::string ask_slots(const SlotRequest& request);
  /// Commits the answer to a request. slots: by place. base::Error unless there is one for each place.
  void hold_slots(const std::string& token, const std::vector<int>& slots);
  /// Commits that no session will take these slots, before the central database is told.
  void release_slots(std::span<const ReservedSlot> slots);
  /// Commits that the central database knows that these slots were released.
  void forget_slots(std::span<const ReservedSlot> slots);

  /// Commits the cells that an adaptive procedure chose for a trial that is not done.
  void choose_cells(std::int64_t session, std::int64_t trial, int first, std::optional<int> second);
  /// The answers of a session to a question of its stimulus block, in the order of the trials' positions.
  /// Omits answers to trials that are excluded or not done, and to showings that were set aside.
  std::vector<TrackAnswer> track_answers(std::int64_t session, const std::string& question);
  /// As track_answers(), of all sessions of the same protocol that were planned before this one, by session
  /// and position. Test data learn from test data alone, people from people alone.
  std::vector<TrackAnswer> earlier_answers(std::int64_t session, const std::string& question);

  /// Commits that a stimulus is about to be shown; returns the presentation's id. interval: 0 for the first
  /// or only stimulus, 1 for the second of a pair. gaze_source: the gaze that the fluid uses; none: the
  /// session's planned source.
  std::int64_t begin_presentation(std::int64_t session, std::int64_t trial, int attempt, int interval,
                                  int cell, std::int64_t start_ns,
                                  const std::optional<std::string>& gaze_source = {});
  /// Commits frames of a running presentation. A planned onset is stored relative to start_ns; the other
  /// times of a frame are stored relative to its planned onset.
  void add_frames(std::int64_t presentation, std::int64_t start_ns, std::span<const FrameRecord> frames);
  /// The codes of participants who asked at the end of a session that all their data be deleted. Close this
  /// Store, then call withdraw() for each of them.
  std::vector<std::string> requested_withdrawals();
  /// True if this session has a presentation (has_shown) or an answer (has_answers).
  bool has_shown(std::int64_t session);
  bool has_answers(std::int64_t session);
  /// True if the participant currently allows recording gaze in this session.
  bool allows_gaze(std::int64_t session);
  /// Commits gaze samples of a presentation and appends them to its earlier samples. base::Error, with
  /// nothing stored, unless the participant allows recording gaze.
  void add_gaze(std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
                std::span<const GazeSample> samples);
  /// Commits headset slots of a presentation and appends them to its earlier slots. base::Error, with nothing
  /// stored, if a slot has a head pose and the participant does not allow recording gaze.
  void add_slots(std::int64_t presentation, std::int64_t start_ns, std::span<const ShownSlot> slots);
  /// Commits a validation of the eye tracker and appends it to the session's earlier validations. base::Error
  /// as add_gaze().
  void add_validation(std::int64_t session, std::span<const ValidatedPoint> points, bool passed);
  /// Commits measured clock offsets of a session's eye tracker.
  void add_tracker_clocks(std::int64_t session, std::span<const TrackerClock> clocks);
  /// Commits markers of a session, and what became of them at their receivers.
  void add_markers(std::int64_t session, std::span<const MarkerRecord> markers);
  /// The receivers to which markers of this session were sent so far.
  std::vector<std::string> marker_receivers(std::int64_t session);
  /// Commits what a sensor's log says about presentations of a session, in place of what an earlier log said.
  void add_light(std::int64_t session, std::span<const LightEvidence> evidence);
  /// Commits a presentation's last frames and its timing verdict. If the trial had no schedule (nominal mean
  /// 0), the verdict is stored only if the trial was cut because it overran.
  void end_presentation(std::int64_t presentation, std::int64_t start_ns, std::int64_t end_ns,
                        std::span<const FrameRecord> frames, const TimingVerdict& verdict);
  /// Commits that a presentation was cut short, and why. Its frames stay in the database.
  void interrupt_presentation(std::int64_t session, std::int64_t presentation, const std::string& why,
                              std::int64_t clock_ns);
  /// Commits the answers of one page in one transaction. attempt: the showing of the trial that the answers
  /// judge; 0 for a page outside a trial. `last` true: marks the unit as done, unless the trial was set aside
  /// after that showing; a session is done with its last unit. `ending`: an early end that the answers
  /// caused, stored with them. Answers about permissions take effect at once. base::Error, with nothing
  /// stored, if a question is personal, unknown or already answered in this unit, or if the unit is done.
  void answer(std::int64_t session, const OpenUnit& unit, int attempt, std::span<const KeptAnswer> answers,
              bool last, std::int64_t clock_ns, const std::optional<Ending>& ending = {});
  /// Commits that a unit is done, for units without questions.
  void finish_unit(std::int64_t session, std::int64_t unit, std::int64_t clock_ns);
  /// Ends a session before its last unit; its open units stay planned. The ending's reason is stored as a
  /// note.
  void end_session(std::int64_t session, const Ending& ending, std::int64_t clock_ns);
  /// Reopens a trial that is done or under way: sets its earlier showings and answers aside, so that it is
  /// shown again as a new attempt. The reason is stored as a note.
  void repeat_trial(std::int64_t session, std::int64_t trial, const std::string& reason);
  /// Reopens every trial of a block that is done or under way, as repeat_trial() does, in one transaction.
  void restart_block(std::int64_t session, int block, const std::string& reason);
  /// Excludes a begun trial from analyses instead of showing it again. Marks its unit as done; its answers
  /// stay.
  void leave_out_trial(std::int64_t session, const OpenUnit& unit, const std::string& reason);
  /// Marks a trial as excluded from analyses.
  void exclude_trial(std::int64_t session, std::int64_t trial, const std::string& reason);
  /// Stores a note of the experimenter in the table `note`; the event log records only that there is one. A
  /// withdrawal deletes both.
  void note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words);
  /// Appends an event to the event log. `detail` must not contain answers or free text of participants.
  void log(std::optional<std::int64_t> session, const std::string& kind, const std::string& detail,
           std::optional<std::int64_t> clock_ns = {});

 private:
  struct Statements;

  std::vector<TrackAnswer> answers_where(const std::string& condition, std::int64_t session,
                                         const std::string& question);

  /// A Store on a temporary copy of a database that another program has locked. Its commits reach only the
  /// journal; the next settle() of the database inserts their rows there.
  explicit Store(Store& locked);
  /// Makes a change that must not be lost: an answer or a note. If another program has locked the file, makes
  /// the change in copy_ and then throws LockedOut.
  void make(const std::function<void(Store&)>& change);
  void write_answers(std::int64_t session, const OpenUnit& unit, int attempt,
                     std::span<const KeptAnswer> answers, bool last, std::int64_t clock_ns,
                     const std::optional<Ending>& ending);
  void write_note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words);
  /// Ends a transaction: writes its rows to the journal, then commits it to the database.
  void commit(sqlite::Transaction& transaction);
  std::int64_t find_or_add_protocol(const RunPlan& run);
  std::int64_t insert_run(const std::string& options);
  std::int64_t add_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                           const SessionPlan& plan, const std::string& not_before_utc);
  void refuse_imported(const ImportedSession& session);
  void insert_imported_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                               const ImportTerms& terms, const ImportedSession& imported);
  void insert_imported_showing(const Protocol& protocol, const ImportedShowing& showing, int interval,
                               std::int64_t session, std::int64_t trial_id);
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

  void set_slot_state(std::span<const ReservedSlot> slots, const char* state);
  void keep_file();

  std::filesystem::path path_;
  std::optional<WriterLock> lock_;  ///< none if this Store writes to a temporary copy
  std::unique_ptr<sqlite::Connection> database_;
  std::unique_ptr<Statements> statements_;
  std::unique_ptr<AnswerJournal> journal_;
  std::mutex copying_;           ///< guards copy_, because the console writes notes from another thread
  std::unique_ptr<Store> copy_;  ///< temporary copy of a locked database, see make()
  std::atomic<bool> given_up_ = false;  ///< true once copy_ exists: nothing more is written to the file
  std::vector<std::string> left_;
};

}  // namespace study
