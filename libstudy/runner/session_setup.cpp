#include "libstudy/runner/session_setup.hpp"

#include <fmt/format.h>

#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/solver/settled_state.hpp"
#include "libstudy/display/null.hpp"
#include "libstudy/headset/headset_recorder.hpp"
#include "libstudy/headset/headset_targets.hpp"
#include "libstudy/pages/gui/page_fonts.hpp"
#include "libstudy/pages/headset/headset_person.hpp"
#include "libstudy/stimulus/cell_features.hpp"
#include "libstudy/stimulus/headless_display.hpp"
#include "libstudy/stimulus/light_patch.hpp"
#include "libstudy/trackers/eye_tracker.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

[[noreturn]] void unknown(const std::string& option, const std::string& word, const std::string& known) {
  throw base::Error(option, "'" + word + "' is not known", "use " + known);
}

std::unique_ptr<Clock> make_clock(const std::string& word) {
  if (word == "virtual") return std::make_unique<VirtualClock>();
  if (word == "real") return std::make_unique<RealClock>();
  unknown("--clock", word, "real or virtual");
}

void check_together(const RunOptions& options, const Protocol& protocol) {
  if (!options.answer.empty() && (options.display != "openxr" || !options.observer.empty()))
    throw base::Error("--answer", "is for a person in a headset",
                      "leave it out, or use --display openxr without an --observer");
  if (options.gaze == "head" && options.display != "openxr")
    throw base::Error("--gaze head", "needs a headset", "use --gaze fixed, or --display openxr");
  const bool outside = is_outside_tracker(options.gaze);
  if (outside && options.display != "openxr")
    throw base::Error("--gaze " + options.gaze, "gives rays from the head, and only a headset knows the head",
                      "use --display openxr, or --gaze fixed or mouse");
  if (outside && options.clock == "virtual")
    throw base::Error("--gaze " + options.gaze,
                      "comes in real time, and time stands still on the virtual clock", "use --clock real");
  if (!outside && options.gaze_turn_deg != std::array<double, 3>{})
    throw base::Error("--gaze-turn", "turns the rays of an eye tracker outside OpenXR",
                      "leave it out, or use --gaze tcp:PORT, tcp:HOST:PORT or lsl:NAME");
  if ((outside || options.gaze == "tracked") && options.display == "openxr" && !asks_gaze(protocol))
    throw base::Error(
        "--gaze " + options.gaze, "is read only with consent, and the protocol does not ask for it",
        std::string("ask ") + gaze_question + " on its page of kind consent, or use --gaze head");
  const bool shows_pages = options.display == "window" || options.display == "openxr";
  if (options.observer.empty() && !shows_pages)
    throw base::Error("--display " + options.display, "shows nothing to a person",
                      "use --display window, or name an --observer");
  if (options.observer.empty() && options.display == "window" && options.clock != "real")
    throw base::Error("--clock virtual", "does not wait for a person", "use --clock real");
  if (options.display == "window" && options.clock != "real")
    throw base::Error("--clock virtual", "does not wait for a window", "use --clock real");
  if (options.gaze == "mouse" && options.display != "window")
    throw base::Error("--gaze mouse", "needs a window", "use --gaze fixed, or --display window");
  if (options.gaze == "tracked" && options.display != "openxr" && options.observer.empty())
    throw base::Error("--gaze tracked", "needs an eye tracker, and only a headset's can be read",
                      "use --gaze fixed or mouse; with an --observer, tracked is allowed");
  if (options.light_patch && options.display == "none")
    throw base::Error("--light-patch", "needs a display, and with --display none nothing is drawn",
                      "use --display window, openxr or headless, or leave it out");
  if (options.light_patch && options.display == "openxr" && options.observer.empty())
    throw base::Error("--light-patch", "would flash at the person: a sensor covers it in one eye at most",
                      "measure the headset with an --observer and the sensor at a lens, or leave it out");
  if (protocol.fixation && options.display != "none" && options.gaze != "fixed")
    throw base::Error("--gaze " + options.gaze, "contradicts gaze = \"fixation\" of the protocol",
                      "use --gaze fixed, or gaze = \"free\" in the protocol");
  if (protocol.design.timing == TimingSource::Native && options.clock == "virtual")
    throw base::Error(protocol.name, "has timing = \"native\", and time stands still on the virtual clock",
                      "use --clock real");
}

std::unique_ptr<Display> make_display(const RunOptions& options) {
  if (options.display == "none") return std::make_unique<NullDisplay>();
  StimulusChoice choice;
  if (!std::filesystem::is_directory(options.bake)) choice.bake = options.bake;
  return std::make_unique<HeadlessDisplay>(options.width_px, options.height_px, shows_pictures(choice));
}

/// Refuses bakes with pictures, which would look flat in a headset. Called before anything is written.
void refuse_pictures(const SessionBakes& bakes, const Protocol& protocol) {
  for (const Cell& cell : protocol.design.cells) {
    const FoundBake* bake = bakes.of(cell);
    if (bake && bake->header.has_pictures()) {
      throw base::Error(bake->path.string(), "holds pictures, which would look flat in a headset",
                        "bake particles for a headset: vip-study bake without --pictures or --keep pictures");
    }
  }
}

/// Applies the options of the run. Requests the runtime's eye tracker for --gaze tracked; the tracker is not
/// read before a participant allows recording. For any eye tracker, adds a page if none is chosen, because
/// the tracker's validation targets are drawn on a page.
HeadsetChoice with_options(HeadsetChoice choice, const RunOptions& options) {
  constexpr int target_px = 128;
  choice.user_presence = !options.ignore_presence;
  const bool outside = is_outside_tracker(options.gaze);
  if (options.gaze != "tracked" && !outside) return choice;
  choice.eye_gaze = choice.eye_gaze || !outside;
  if (choice.page_width_px == 0) choice.page_width_px = choice.page_height_px = target_px;
  return choice;
}

/// Sets up the headset's recording and the gaze that the fluid follows.
void record_headset(const RunOptions& options, HeadsetDisplay& display, SessionSetup& setup,
                    Viewing& viewing) {
  const bool tracked = options.gaze == "tracked";
  if (tracked && !display.session().eye_gaze)
    throw base::Error("--gaze tracked", "the headset's software offers no eye tracker",
                      "switch eye tracking on in the headset's software, or use --gaze head");
  const auto outside = is_outside_tracker(options.gaze)
                           ? std::make_shared<EyeTracker>(options.gaze, options.gaze_turn_deg)
                           : nullptr;
  const auto recorder =
      outside ? std::make_shared<HeadsetRecorder>(display, outside)
              : std::make_shared<HeadsetRecorder>(display, tracked ? GazeOrigin::Tracker : GazeOrigin::Head);
  setup.slots = recorder;
  if (tracked || outside) setup.targets = std::make_unique<HeadsetTargets>(display, outside);
  if (!tracked && !outside && options.gaze != "head") return;
  setup.gaze = recorder;
  viewing.ray = [recorder] { return recorder->ray(); };
}

/// Sets up the headset as display, with its own clock (HeadsetClock).
void take_headset(const RunOptions& options, const Protocol& protocol, SessionSetup& setup,
                  Viewing& viewing) {
  const bool person = options.observer.empty();
  const AnswerWays ways = parse_answer_ways(options.answer.empty() ? usual_answer_ways : options.answer);
  const SlotDrive drive = setup.virtual_clock ? SlotDrive::Caller : SlotDrive::Thread;
  const HeadsetChoice choice = with_options(person ? choice_for_person(ways) : HeadsetChoice{}, options);
  auto headset = std::make_unique<HeadsetDisplay>(drive, choice, protocol.headset);
  record_headset(options, *headset, setup, viewing);
  setup.clock = std::make_unique<HeadsetClock>(*headset);
  setup.request = headset_requests(*headset);
  if (person) {
    HeadsetPerson parts = make_headset_person(*headset, ways, protocol, *setup.clock);
    setup.participant = std::move(parts.participant);
    setup.request = std::move(parts.request);
    setup.idle = std::move(parts.idle);
    setup.listen = std::move(parts.listen);
  }
  setup.open_mirror = [display = headset.get(), mirror = std::shared_ptr<void>()](bool reveal) mutable {
    mirror = open_headset_mirror(*display, reveal);
  };
  setup.display = std::move(headset);
}

/// Where the patch for a light sensor is, and its size. base::Error if it would be too large.
std::string patch_words(const RunOptions& options, const base::PictureSize& size) {
  if (options.display == "openxr")
    return fmt::format("{:g} degrees, in the lower left of both eyes' pictures", eye_patch_deg);
  return describe_patch(size.width, size.height, options.screen_width_mm.value_or(0),
                        options.viewing_distance_mm.value_or(0)) +
         ", in the lower left corner";
}

/// Picture features for the frames observer: measured on live pictures before the session, or taken from the
/// table with --display none or with bakes. Other observers get the table, which they do not read.
std::unique_ptr<FeatureSource> make_features(const RunOptions& options, const Protocol& protocol,
                                             const CellStimuli& stimuli) {
  const bool looks = options.observer.find("frames") != std::string::npos;
  if (!looks || options.display == "none" || !options.bake.empty()) return std::make_unique<FeatureTable>();
  auto features = std::make_unique<CellFeatures>(
      sim::default_cache_folder(), [&stimuli](const Cell& cell) { return stimuli.choice_of(cell); });
  features->measure(protocol);
  return features;
}

/// Reads the PTPE model. For a scheduled cell, the tolerance tau is computed from the protocol's kind of mean
/// frame rate (harmonic or arithmetic), so the model must have been fitted to the same kind of mean.
stats::PtpeModel model_of(const std::optional<std::string>& ptpe, const std::string& place,
                          const Protocol& protocol) {
  if (!ptpe) return {};
  const stats::PtpeModel model = sim::parse_ptpe_file(*ptpe, place).model;
  if (protocol.design.timing != TimingSource::Native && model.mean != protocol.pacing.mean) {
    throw base::Error(place,
                      "was fitted to another mean of the frame rate than protocol '" + protocol.name +
                          "' sets (pacing.mean)",
                      "fit it again from a pilot of that mean, or change pacing.mean of the protocol");
  }
  return model;
}

}  // namespace

bool asks_gaze(const Protocol& protocol) {
  const auto all = all_questions(protocol);
  return std::any_of(all.begin(), all.end(),
                     [](const auto& entry) { return entry.second->id == gaze_question; });
}

WindowRequest headset_requests(HeadsetDisplay& display) {
  return [&display](const std::function<Request()>& others) -> Request {
    auto spoilt = display.take_explained();
    if (!spoilt) return others();
    do {
      if (others() == Request::Stop) return Request::Stop;
      // The loop runs at least once, because the headset may report an unseen frame before the event that
      // caused it.
      display.turn();
    } while (!display.focused());
    // Adds the cuts that the headset reported during the loop, in which nothing was shown.
    if (const auto more = display.take_spoilt()) note_cut(spoilt, *more);
    return *spoilt;
  };
}

std::string SessionSetup::departure() const {
  std::string out = stimuli->bakes().departure();
  for (const FramedScene& one : scenes) {
    if (!one.departure.empty()) out += (out.empty() ? "" : ", ") + one.departure;
  }
  return out;
}

SessionSetup make_session_setup(const RunOptions& options, const Protocol& protocol,
                                const std::optional<std::string>& ptpe, const std::string& ptpe_place,
                                const std::string& setting_place) {
  check_together(options, protocol);
  if (options.observer.empty()) check_pages(protocol);
  SessionSettings settings(options.settings, protocol, setting_place);
  SessionSetup setup;
  setup.virtual_clock = options.clock == "virtual";
  setup.clock = make_clock(options.clock);
  Viewing viewing = screen_viewing(options.screen_width_mm, options.viewing_distance_mm,
                                   protocol.true_angle && options.display != "none");
  base::PictureSize size{options.width_px, options.height_px};
  if (options.display == "window") {
    WindowParts window = make_window_parts(options, protocol);
    setup.display = std::move(window.display);
    setup.participant = std::move(window.person);
    if (options.gaze == "mouse") {
      viewing.gaze = window.gaze;
      setup.gaze = std::move(window.mouse);
    }
    setup.request = std::move(window.request);
    setup.idle = std::move(window.idle);
    setup.open_mirror = std::move(window.open_mirror);
    setup.poll = std::move(window.poll);
    setup.screen = window.screen;
    size = window.size;
  } else if (options.display == "openxr") {
    take_headset(options, protocol, setup, viewing);
  } else {
    setup.display = make_display(options);
  }
  if (options.light_patch) setup.light_patch = patch_words(options, size);
  const stats::PtpeModel model = model_of(ptpe, ptpe_place, protocol);
  SessionLook look{{}, size};
  look.common.model = model;
  look.common.viewing = viewing;
  SessionBakes bakes(options.bake, protocol, look);
  if (options.display == "openxr") {
    refuse_pictures(bakes, protocol);
  } else if (options.display != "none") {
    setup.scenes = frame_scenes(protocol, viewing, size, bakes, sim::gl_description());
  }
  check_visible(setup.scenes);
  check_one_picture(protocol, setup.scenes);
  setup.stimuli = std::make_unique<CellStimuli>(options, protocol, model, std::move(viewing),
                                                std::move(bakes), std::move(settings));
  if (!options.observer.empty()) {
    setup.features = make_features(options, protocol, *setup.stimuli);
    auto observer = make_observer(options.observer, *setup.features);
    if (protocol.design.procedure) observer->set_steering_question(protocol.design.procedure->question);
    setup.participant = std::move(observer);
  }
  return setup;
}

}  // namespace study
