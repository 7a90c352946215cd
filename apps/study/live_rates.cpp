#include "apps/study/live_rates.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "apps/study/session_player.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/solver/settled_state.hpp"
#include "libstudy/check/kept_times.hpp"
#include "libstudy/check/measuring.hpp"
#include "libstudy/stimulus/bakes/bake_plan.hpp"
#include "stats/base/duration.hpp"
#include "stats/base/error.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/program.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

const study::Cell& first_cell(const study::Protocol& protocol, const study::MeasuredStimulus& one) {
  return protocol.design.cells.at(static_cast<std::size_t>(one.cells.front()));
}

/// The stimuli that have live cells, whose fluid is computed while it is shown. MeasuredStimulus::cells
/// contains only the live cells.
std::vector<study::MeasuredStimulus> live_stimuli(const study::Protocol& protocol,
                                                  const study::CellStimuli& stimuli) {
  std::vector<study::MeasuredStimulus> out;
  for (const study::PlannedStimulus& planned : study::plan_bakes(protocol)) {
    study::MeasuredStimulus one{{}, sim::traits_of(sim::parse_method(planned.what.method)).temporal, {}};
    for (const int cell : planned.cells) {
      if (stimuli.is_live(protocol.design.cells.at(static_cast<std::size_t>(cell))))
        one.cells.push_back(cell);
    }
    if (!one.cells.empty()) out.push_back(std::move(one));
  }
  return out;
}

const study::FramedScene& framed(int cell, const MeasuringPlace& place) {
  for (const study::FramedScene& scene : place.scenes) {
    if (std::find(scene.cells.begin(), scene.cells.end(), cell) != scene.cells.end()) return scene;
  }
  throw std::logic_error(
      "measure_live(): the scene of a cell is not in MeasuringPlace::scenes; frame all scenes first");
}

/// Size and angles with which the display shows a cell; for a headset, the display's description.
std::string look_of(int cell, const MeasuringPlace& place) {
  if (place.scenes.empty()) return place.display.description();
  const study::FramedScene& scene = framed(cell, place);
  std::ostringstream out;
  out << scene.view.viewport.width << 'x' << scene.view.viewport.height << ", camera "
      << base::shortest(scene.framing.camera_deg) << ", eye "
      << base::shortest(scene.framing.visual_deg.value_or(0));
  return out.str();
}

/// Cache key of the measured times. It contains everything on which the times depend: stimulus, framing,
/// numbers of steps, tau, machine, renderer and program.
std::string key_of(const study::Protocol& protocol, const study::CellStimuli& stimuli,
                   const study::MeasuredStimulus& one, const std::string& description,
                   const MeasuringPlace& place) {
  const study::Cell& cell = first_cell(protocol, one);
  std::ostringstream key;
  key << description << "; " << look_of(one.cells.front(), place) << "; from step "
      << protocol.content.start_frame << " by " << base::shortest(protocol.content.content_step_s) << " s";
  for (const int index : one.cells) {
    const auto& setting = protocol.design.cells.at(static_cast<std::size_t>(index)).setting;
    key << ", " << study::content_steps(protocol, setting, place.refresh_hz) << " in "
        << base::shortest(setting.duration_s) << " s";
  }
  const study::StimulusChoice choice = stimuli.choice_of(cell);
  if (const auto& rate = choice.fixed_rate; rate && one.temporal)
    key << "; tau " << base::shortest(stats::ptpe_tolerance(choice.model, rate->mean, rate->sd));
  key << "; " << base::describe_machine() << "; " << sim::gl_description() << "; program "
      << base::program_digest();
  return key.str();
}

void tell_length(const study::Protocol& protocol, const std::vector<const study::MeasuredStimulus*>& open,
                 const MeasuringPlace& place) {
  double seconds = 0;
  for (const study::MeasuredStimulus* one : open) seconds += study::longest_measuring_s(protocol, *one);
  std::string where = "in the headset";
  if (!place.scenes.empty()) {
    const auto& drawn = place.scenes.front().view.viewport;
    where = "at " + std::to_string(drawn.width) + "x" + std::to_string(drawn.height);
  }
  std::fprintf(stderr,
               "%s: measuring %zu live stimul%s %s, up to %s plus the time to prepare them, once for this "
               "station and build\n",
               base::for_terminal(protocol.name).c_str(), open.size(), open.size() == 1 ? "us" : "i",
               where.c_str(), base::duration_words(seconds).c_str());
}

/// Text of the error, such as "3 of 30 live cells do not reach their setting, for example HiRes faucet 32k at
/// (17, 4): ...".
std::string refusal(const study::MeasuredReport& report) {
  const auto slow = [](const study::MeasuredCell& one) { return one.too_slow; };
  const auto count = std::count_if(report.cells.begin(), report.cells.end(), slow);
  const study::MeasuredCell& first = *std::find_if(report.cells.begin(), report.cells.end(), slow);
  return std::to_string(count) + " of " + std::to_string(report.cells.size()) +
         " live cells do not reach their setting, for example " + study::stimulus_name(first.what) +
         (first.setting.mean > 0 ? " at " + study::setting_name(first.setting) : "") + ": " + first.words;
}

std::function<void()> stoppable(const study::Protocol& protocol, const study::SessionSetup& setup) {
  return [&setup, &protocol] {
    if (setup.poll) setup.poll();
    if (StopSignals::stop_requested())
      throw base::Error(protocol.name, "stopped while live cells were measured; nothing was shown",
                        "give the command again");
  };
}

study::MeasuredReport judge_here(const study::Protocol& protocol, const study::SessionSetup& setup,
                                 const LiveTimes& live) {
  const study::Display& display = *setup.display;
  return study::judge_measured(protocol, live.stimuli, display.refresh_hz(),
                               [&](const study::FpsSetting& setting) {
                                 return study::trial_intervals(protocol, setting, display, 0);
                               });
}

std::set<int> slow_by_kept(const study::MeasuredReport& report, const LiveTimes& live) {
  std::set<int> out;
  for (const study::MeasuredCell& one : report.cells) {
    if (one.too_slow && live.kept.count(one.cell) > 0) out.insert(one.cell);
  }
  return out;
}

}  // namespace

LiveTimes measure_live(const study::Protocol& protocol, study::CellStimuli& stimuli,
                       const MeasuringPlace& place) {
  LiveTimes out{live_stimuli(protocol, stimuli), {}};
  const std::filesystem::path folder = sim::default_cache_folder();
  std::vector<study::MeasuredStimulus*> open;
  const auto key = [&](const study::MeasuredStimulus& one) {
    const auto& what = stimuli.stimulus(first_cell(protocol, one));
    return key_of(protocol, stimuli, one, what.description(), place);
  };
  for (study::MeasuredStimulus& one : out.stimuli) {
    const bool anew = place.anew && std::any_of(one.cells.begin(), one.cells.end(), place.anew);
    const auto kept = anew ? std::nullopt : study::read_step_times(folder, key(one));
    if (kept) {
      one.times = *kept;
      out.kept.insert(one.cells.begin(), one.cells.end());
    } else {
      open.push_back(&one);
    }
  }
  if (open.empty()) return out;
  tell_length(protocol, {open.begin(), open.end()}, place);
  study::RealClock clock;
  base::Progress progress("stimuli measured", open.size());
  for (std::size_t i = 0; i < open.size(); ++i) {
    study::Stimulus& stimulus = stimuli.stimulus(first_cell(protocol, *open[i]));
    open[i]->times = study::measure(protocol, open[i]->cells, stimulus, place.display, clock,
                                    place.refresh_hz, place.each);
    study::keep_step_times(folder, key(*open[i]), open[i]->times);
    progress.update(i + 1);
  }
  return out;
}

study::MeasuredReport check_live(const study::Protocol& protocol, study::SessionSetup& setup,
                                 bool accept_slow) {
  if (setup.virtual_clock) return {};
  MeasuringPlace place{
      *setup.display, setup.scenes, setup.display->refresh_hz(), stoppable(protocol, setup), {}};
  LiveTimes live = measure_live(protocol, *setup.stimuli, place);
  study::MeasuredReport report = judge_here(protocol, setup, live);
  const std::set<int> doubtful = slow_by_kept(report, live);
  if (!doubtful.empty() && !accept_slow) {
    std::fprintf(stderr, "%s: too slow by the stored rates; they are measured again\n",
                 base::for_terminal(protocol.name).c_str());
    place.anew = [&doubtful](int cell) { return doubtful.count(cell) > 0; };
    report = judge_here(protocol, setup, measure_live(protocol, *setup.stimuli, place));
  }
  if (report.cells.empty()) return report;
  std::fprintf(stderr, "%s: live on this station\n%s\n", base::for_terminal(protocol.name).c_str(),
               base::for_terminal(study::measured_table(report)).c_str());
  if (!report.collapse.empty())
    std::fprintf(stderr, "%s: timing = \"native\" compares equal stimuli here: %s\n",
                 base::for_terminal(protocol.name).c_str(), base::for_terminal(report.collapse).c_str());
  if (report.too_slow && !accept_slow)
    throw base::Error(
        protocol.name + " on this station", refusal(report),
        "bake the stimuli that can be baked, make the picture smaller, use a faster machine, or add "
        "--accept-slow");
  return report;
}

}  // namespace apps
