#include "libstudy/protocol/reference.hpp"

#include "libstudy/protocol/names.hpp"
#include "libstudy/protocol/procedure.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

using base::where_needed;

bool is_rated(const AnswerKindTraits& one) { return one.rated(); }
bool has_scale(const AnswerKindTraits& one) { return one.scored && !one.labelled && !one.timed; }

std::string in_quotes(std::vector<std::string> words) {
  for (std::string& word : words) word = "\"" + word + "\"";
  return base::joined(words);
}

std::string kinds_in_quotes() {
  std::vector<std::string> out;
  for (const AnswerKindTraits& one : answer_kinds()) out.emplace_back(one.word);
  return in_quotes(std::move(out));
}

std::string kind_meanings() {
  std::string out;
  for (const AnswerKindTraits& one : answer_kinds())
    out += (out.empty() ? "" : ". ") + std::string(one.word) + ": " + one.meaning;
  return out;
}

}  // namespace

const std::vector<KeyReference>& protocol_reference() {
  static const std::vector<KeyReference> keys{
      {"", "format", "whole number", "", "", "2, or 3: factors and timing profiles of your own"},
      {"", "name", "text", "", "", "of the study; stored with the data"},
      {"", "version", "text", "", "", "of the study, such as \"1.0\"; another text needs another version"},
      {"", "language", "text", "", "",
       "of all texts, such as \"en\"; of fonts that have a character, the one for this language is taken"},
      {"", "participants", "whole number", "[1, 100000]", "",
       "planned; `vip-study check` says what the number leaves unbalanced"},
      {"", "accept_approximate", "true or false", "", "false",
       "also play settings that the display meets only approximately"},
      {"", "accept_mixed_pictures", "true or false", "", "false",
       "also compare stimuli of a scene whose pictures differ in renderer, size or angle, as baked and live "
       "ones can; the report names it"},
      {"", "gaze", "text", "\"free\", \"fixation\"", "\"free\"",
       "fixation: the texts tell participants to look at the middle of the picture, where levels then are "
       "fine; methods that follow the gaze can be baked"},
      {"", "needs_gaze", "true or false", "", "false",
       "without tracked gaze some hypotheses are labelled not testable"},
      {"", "camera_angle", "text", "\"scene\", \"true\"", "\"scene\"",
       "scene: the camera keeps the scene's angle. true: it has the angle that the picture fills of the "
       "eye's view, refused where that cuts what must stay visible"},
      {"", "design", "table", "", "", "what is shown"},
      {"", "pacing", "table", "", "", "how frames are timed"},
      {"", "content", "table", "", "", "how the process elapses"},
      {"", "timing", "table", "", "all its defaults", "what a trial must meet"},
      {"", "headset", "table", "", "all its defaults", "how a headset shows it; nothing to a desktop"},
      {"", "block", "tables", "", "", "the session, 200 blocks at most"},

      {"", "stimulus", "table", "", where_needed, "format 3: what each stimulus shows"},
      {"", "factor", "tables", "", where_needed, "format 3: needed, 1 to 10 factors"},
      {"", "combination", "tables", "", "all combinations", "format 3: the cells"},

      {"stimulus", "scene", "text", "", where_needed, "scene file"},
      {"stimulus", "method", "text", "", where_needed, base::joined(method_names())},
      {"stimulus", "n_star", "text", "", where_needed,
       "number of particles if all were at the coarsest level; \"32k\" = 32,768"},
      {"stimulus", "effects", "text", "", "those of the scene",
       "none: no effects. scene: those of the scene's file. Another name has a table [[design.effect_set]]"},
      {"stimulus", "surface", "text", in_quotes(surface_names()), "ellipsoids",
       "how the particles are drawn ([methods.md](methods.md#the-drawn-surface)). If written, the word "
       "stands beside the method in reports and files"},
      {"stimulus", "timing", "table", "", where_needed, "how long each frame stays on"},

      {"stimulus.timing", "profile", "text", "\"moments\", \"hitches\", \"floor\", \"trace\"", "",
       "as above"},
      {"stimulus.timing", "mean_fps", "number", "[0.1, 1000]", where_needed, "frames over time, frames/s"},
      {"stimulus.timing", "sd_fps", "number", "[0, 1000]", "0", "below mean_fps, frames/s"},
      {"stimulus.timing", "base_fps", "number", "[0.1, 1000]", where_needed,
       "frame rate between hitches, frames/s"},
      {"stimulus.timing", "hitch_ms", "number", "[1, 10000]", where_needed,
       "time for which the long frame stays on; at least 1000 / base_fps, which is no hitch, ms"},
      {"stimulus.timing", "period_s", "number", "[0.01, 3600]", where_needed,
       "one hitch in each period, in its middle; at most duration_s, s"},
      {"stimulus.timing", "jitter", "number", "[0, 1]", "0",
       "the hitch comes at a random time in this middle part of its period"},
      {"stimulus.timing", "low_fps", "number", "[0.1, 1000]", where_needed,
       "rate of the slowest 5 % of the frames; at most mean_fps, frames/s"},
      {"stimulus.timing", "frame_ms", "list of numbers", "[0.1, 10000]", where_needed,
       "2 to 100,000 frame times, ms"},
      {"stimulus.timing", "smoothed", "true or false", "", "false",
       "true: as many frames in the same time, all equally long"},
      {"stimulus.timing", "latency_ms", "number", "[0, 10000]", "0",
       "the content lags behind by this constant: it stands still until the lag has passed, then elapses as "
       "usual. "
       "Without an event to compare it with, a viewer sees the still picture alone, ms"},
      {"stimulus.timing", "animation_error_ms", "number", "[0, 1000]", "0",
       "the step of the content differs from the step of the display by this much, alternately more and "
       "less, "
       "ms"},

      {"factor", "name", "text", "", "", "an id: a letter, then letters, digits and '_', 64 at most"},
      {"factor", "vary", "text", "\"within\", \"between\"", "",
       "within: each participant sees all levels. between: one level, dealt by quota"},
      {"factor", "level", "tables", "", "", "2 to 100 levels"},

      {"factor.level", "name", "text", "", "", "an id"},

      {"combination", "FACTOR", "text", "", "", "a level of each factor, as in `hitch = \"h50\"`"},

      {"", "procedure", "table", "", "none", "format 3: adaptive trials"},

      {"procedure", "kind", "text", "\"staircase\", \"quest_plus\", \"ptpe\"", "", "as above"},
      {"procedure", "factor", "text", "", "", "a within-subject factor, whose levels set the timing"},
      {"procedure", "axis", "text", in_quotes(axis_keys()), where_needed,
       "key of the timing of each level; its values rise from level to level"},
      {"procedure", "question", "text", "", "",
       "id of a question that the trials ask: of kind choice with two answers or yes_no, for ptpe of kind " +
           kind_words(is_rated, " or ")},
      {"procedure", "positive", "whole number or text", "[0, 100] or \"comparison\", \"standard\"",
       where_needed,
       "the answer that a stronger stimulus makes more frequent: a score, or in pairs the interval that is "
       "chosen"},
      {"procedure", "trials", "whole number", "[1, 500]", "", "of each track"},
      {"procedure", "start", "text", "", where_needed, "level of the first trial"},
      {"procedure", "steps", "list of numbers", "[1, 100]", "[1]",
       "size of a step, in levels, by the number of reversals so far; the last one holds from there on"},
      {"procedure", "down_after", "whole number", "[1, 10]", "1",
       "positive answers in a row for a step down"},
      {"procedure", "up_after", "whole number", "[1, 10]", "1", "other answers in a row for a step up"},
      {"procedure", "up_ratio", "number", "[0.1, 10]", "1", "size of a step up relative to a step down"},
      {"procedure", "fast_start", "true or false", "", "false",
       "until the first reversal each answer moves the track"},
      {"procedure", "form", "text", "\"normal\", \"logistic\", \"weibull\"", "\"weibull\"",
       "psychometric function; weibull needs values above 0"},
      {"procedure", "guess", "number", "[0, 0.9]", "0", "lower asymptote: 0.5 for forced choice between two"},
      {"procedure", "lapse", "list of numbers", "[0, 0.2]", "[0, 0.02, 0.04]", "lapse rates of the grid"},
      {"procedure", "fixed", "whole number", "[0, 500]", "0; ptpe: trials / 5, 2 or more",
       "quest_plus: first trials at levels spread evenly; ptpe: trials, spread over the session, at the "
       "middle one of the standard deviations"},
      {"procedure", "most_of_one", "whole number", "[1, 500]", "trials",
       "times that a level is chosen at most"},

      {"design", "timing", "text", "\"settings\", \"native\", \"equal\", \"table2\"", "",
       "settings: all of mean_fps and sd_fps (pilot). native: as fast as each method runs. equal: one "
       "mean_fps and sd_fps for all. table2: each cell's own of `moments`"},
      {"design", "scene", "list of texts", "", "", "scene files"},
      {"design", "method", "list of texts", "", "", base::joined(method_names())},
      {"design", "n_star", "list of texts", "", "",
       "number of particles if all were at the coarsest level; \"32k\" = 32,768"},
      {"design", "effects", "list of texts", "", "not varied",
       "levels of the factor effects, 2 to 20; refused under settings. none: no effects. scene: those of the "
       "scene's file. Another level has a table `effect_set`. Without this key each scene has its own"},
      {"design", "effect_set", "tables", "", where_needed, "needed by each level but none and scene"},
      {"design", "overlay", "text", "\"none\", \"temperature\"", "\"none\"",
       "temperature: painted over the water of every stimulus, dark blue to yellow from the coldest to the "
       "hottest that its scene names. Every scene, and every level of effects, then has heat"},
      {"design", "duration_s", "number", "[0.1, 3600]", "", "of each stimulus, s"},
      {"design", "mean_fps", "list of numbers", "[0.1, 1000]", where_needed,
       "means of the frame rate, frames/s; needed under settings and equal, refused otherwise"},
      {"design", "sd_fps", "list of numbers", "[0, 1000]", where_needed,
       "standard deviations, frames/s; as mean_fps"},
      {"design", "moments", "tables", "", where_needed,
       "needed under table2, one for each cell whatever its effects"},
      {"design", "pairs", "true or false", "", "false",
       "each trial shows two cells of a group: all unordered pairs"},
      {"design", "standard", "table", "", "all pairs",
       "format 3, with pairs: each trial shows a cell and its standard, in an order dealt evenly"},
      {"design", "repetitions", "whole number", "[1, 200]", "1",
       "format 3: trials of each cell, or pair, in a session; not with [procedure]"},
      {"design", "groups", "whole number", "[1, 100]", "1",
       "that a participant meets: different scenes, n_* spread as evenly as can be"},
      {"design", "order", "text", "\"shuffle\", \"latin\", \"williams\", \"constrained\"", "",
       "of the trials of a group. shuffle: every order equally likely. latin: each trial equally often at "
       "each place. williams: and directly after each other one. constrained: shuffled until "
       "`never_adjacent` holds; not for pairs"},
      {"design", "never_adjacent", "list of texts", "", where_needed,
       "needed under constrained: method, effects, mean_fps, sd_fps, in format 3 names of factors; "
       "neighbours "
       "share none of them"},
      {"design", "assignment", "text", "\"balanced\", \"paper_random\"", "\"balanced\"",
       "balanced: sequences of groups, rows and the order within pairs are dealt by quota over all in the "
       "database who took part and did not drop out; another database has a quota of its own. paper_random: "
       "drawn for each participant"},

      {"design.standard", "FACTOR", "text", "", "that of the comparison",
       "a level of a within-subject factor. Name at least one factor. With `[procedure]`, name its "
       "factor too"},

      {"design.moments", "scene", "text", "", "", "as in design.scene"},
      {"design.moments", "method", "text", "", "", "as in design.method"},
      {"design.moments", "n_star", "text", "", "", "as in design.n_star"},
      {"design.moments", "mean_fps", "number", "[0.1, 1000]", "", "frames/s"},
      {"design.moments", "sd_fps", "number", "[0, 1000]", "", "below mean_fps, frames/s"},

      {"design.effect_set", "name", "text", "", "", "the level"},
      {"design.effect_set", "keep", "list of texts", "", "none",
       "kinds of effects that stay as the scene's file lists them, such as \"foam\""},
      {"design.effect_set", "effect", "tables", "", where_needed, "further effects, of other kinds"},

      {"design.effect_set.effect", "kind", "text", "", "", "as in a scene file, such as \"foam\""},
      {"design.effect_set.effect", "KEY", "number", "[0, inf]", where_needed,
       "the coefficient, and options, as in a scene file: `emission_per_s = 0.3`"},

      {"pacing", "mean", "text", "\"harmonic\", \"arithmetic\"", "\"harmonic\"",
       "harmonic: frames over time. arithmetic: mean of 1/dt. Both are stored"},
      {"pacing", "fps_min", "number", "[0.1, 1000]", "", "lowest instantaneous rate, frames/s"},
      {"pacing", "fps_max", "number or text", "[0.1, 1000] or \"none\", \"refresh\"", "\"none\"",
       "highest instantaneous rate, frames/s; refresh: the display's"},
      {"pacing", "max_interval_ms", "number", "[1, 10000]", "",
       "longest interval; at least 1000 / fps_min, ms"},
      {"pacing", "order", "text", "\"white\", \"ar1\", \"trace\"", "\"white\"",
       "of the intervals. white: shuffled. ar1: correlated. trace: in the order of a recording"},
      {"pacing", "ar1", "number", "[-0.99, 0.99]", where_needed,
       "needed under ar1: correlation of neighbours"},
      {"pacing", "trace_fps", "list of numbers", "(0, inf]", where_needed,
       "needed under trace: two recorded rates or more"},

      {"content", "mode", "text", "\"per_frame\", \"real_time\"", "",
       "per_frame: frame i shows step start_frame + i. real_time: the step that the time has come to"},
      {"content", "content_step_s", "number", "[1e-05, 1]", "", "fluid time of a content step, s"},
      {"content", "start_frame", "whole number", "[0, 1000000000]", "",
       "content step that each stimulus starts from"},
      {"content", "at_end", "text", "\"loop\", \"hold\"", "",
       "when baked content runs out: back to start_frame, or hold the last step"},

      {"timing", "late_after_ms", "number", "[0, 1000]", "0.5",
       "a frame shown later than this after its deadline is late, ms"},
      {"timing", "mean_relative", "number", "[0, 1]", "0.005", "bound on the mean, as a part of it"},
      {"timing", "sd_relative", "number", "[0, 1]", "0.02",
       "bound on the standard deviation, as a part of it; the wider of the two counts"},
      {"timing", "sd_absolute_fps", "number", "[0, 100]", "0.25", "the same, frames/s"},
      {"timing", "fail_mean_relative", "number", "[0, 1]", "0.05",
       "beyond this a trial has failed; at least mean_relative"},
      {"timing", "fail_sd_relative", "number", "[0, 1]", "0.2",
       "at least sd_relative; the wider of the two counts"},
      {"timing", "fail_sd_absolute_fps", "number", "[0, 1000]", "2.5", "at least sd_absolute_fps, frames/s"},
      {"timing", "overrun_s", "number", "[0, 3600]", "duration_s, at least 5",
       "a showing that goes on for longer than this past its planned end is cut and has failed; its "
       "questions are asked, s"},

      {"headset", "hold", "text", "\"image\", \"state\", \"head_locked\"", "\"image\"",
       "what happens to a picture that stays on while the head moves. image: it stays where it was drawn, "
       "as in the paper. state: the fluid stands still and is drawn anew in each period, which hides judder "
       "of the head and so changes what is rated. head_locked: it moves with the head. Data of different "
       "modes are not pooled"},
      {"headset", "acknowledge", "list of texts", "\"head_locked\"", where_needed,
       "that head_locked makes people sick; needed for it"},
      {"headset", "hold_margin_deg", "number", "[0, 30]", "0",
       "held images reach this far beyond the eyes' view on each side, at as many pixels: a turning head "
       "sees no edge"},
      {"headset", "world_scale", "number", "[0.01, 100]", "1", "metres of the room for a metre of the scene"},
      {"headset", "refresh_hz", "number", "[10, 1000]", "as it is",
       "requested from the headset, Hz; no session begins and no trial is shown at another rate"},

      {"block", "kind", "text",
       "\"instructions\", \"screening\", \"consent\", \"demographics\", \"practice\", \"stimulus\", "
       "\"question\", \"rest\", \"break\", \"black\", \"repeat\", \"catch\", \"ssq\", \"gaze_validation\", "
       "\"fms\", \"debrief\"",
       "", "as above"},
      {"block", "id", "text", "", "", "unique: a letter, then letters, digits and '_', 64 at most"},
      {"block", "title", "text", "", "\"\"", "heading of the page; not for black and gaze_validation"},
      {"block", "text", "text", "", "\"\"",
       "of the page, paragraphs parted by empty lines; needed by instructions, consent and debrief, not for "
       "black and blocks of trials"},
      {"block", "seconds", "number", "[0, 3600]", "0",
       "needed by rest, break and black: their length. instructions, debrief: the least time. Not for "
       "others, s"},
      {"block", "count", "whole number", "[1, 1000]", where_needed,
       "needed by practice, repeat and catch: trials or pages; for repeat and catch at most the trials of "
       "the design"},
      {"block", "tries", "whole number", "[1, 20]", "3", "gaze_validation: at most this many tries"},
      {"block", "extent_deg", "number", "[1, 30]", "10",
       "gaze_validation: of the outer targets from the middle one, across and up, degrees"},
      {"block", "max_accuracy_deg", "number", "[0.1, 20]", "any",
       "gaze_validation: a mean error over this is tried again; after the last try the session is left to be "
       "resumed, degrees"},
      {"block", "like", "text", "", where_needed,
       "needed by practice, repeat and catch: id of the stimulus block. Practice comes before it, repeats "
       "after it"},
      {"block", "stop_at", "whole number", "[1, 20]", "never",
       "fms: this score or more ends the session: a rest, then the exit; the same in all fms blocks"},
      {"block", "steps", "list of texts", "", where_needed,
       "needed by stimulus: what each trial does, one after another: \"black 3\", \"rest 30\" (seconds, 0 to "
       "3600), \"stimulus\" (for pairs \"stimulus first\", \"stimulus second\"), \"ask ID ID ...\" (one page "
       "of questions of a block of kind stimulus, question, ssq or fms)"},
      {"block", "between_groups_s", "number", "[0, 3600]", "0",
       "stimulus: a break before each group but the first, s"},
      {"block", "break_every", "whole number", "[1, 1000]", "no break",
       "stimulus, format 3: trials from one break to the next"},
      {"block", "break_s", "number", "[0, 3600]", where_needed,
       "needed by break_every: the least duration of each break, s; the participant ends it"},
      {"block", "on_interruption", "text", "\"resume\", \"restart_block\", \"invalidate\"", "\"resume\"",
       "stimulus, for its practice and repeats too: what `vip-study resume` does about a trial that was cut. "
       "resume shows it again, restart_block all trials of its block, invalidate none: it is excluded. What "
       "was shown and answered stays"},
      {"block", "question", "tables", "", where_needed, "what is asked"},

      {"block.question", "id", "text", "", "",
       "unique in the file; as the id of a block, but not fms or ssq_...; gaze_kept and data_shared as "
       "above"},
      {"block.question", "text", "text", "", "", "the exact wording"},
      {"block.question", "language", "text", "", "that of the file", "of the wording"},
      {"block.question", "kind", "text", kinds_in_quotes(), "", kind_meanings()},
      {"block.question", "scale", "list of numbers", "[0, 10000]", where_needed,
       "needed by " +
           kind_words([](const AnswerKindTraits& one) { return has_scale(one) && !one.line; }, " and ") +
           ": [lowest, highest], whole; a scale has 101 scores at most. vas: [0, 100] if it is missing, at "
           "most [0, 1000]"},
      {"block.question", "anchors", "table", "", "none",
       "words by score, ascending; needed by " +
           kind_words([](const AnswerKindTraits& one) { return one.labelled && !one.yes_no; }, " and ") +
           ", from 0 to 100, and by vas: for both ends and no other score. yes_no: for 0 and 1; not needed "
           "in English and German; their first letters are keys"},
      {"block.question", "level", "number", "within the scale", "the scale's middle",
       kind_words(is_rated, " and ") + ": the score at which the curve of a pilot's frame rates is fitted: "
                                       "by fit-ptpe, report and power, and "
                                       "named in the preregistered plan; refused for other kinds"},
      {"block.question", "timeout_s", "number", "[0.1, 60]", "5",
       "reaction: without a press the page closes after this time, s"},
      {"block.question", "personal", "true or false", "", "false",
       "the answer goes to the file of personal data alone; only on pages"},
      {"block.question", "required", "true or false", "",
       "true; false for " + kind_words([](const AnswerKindTraits& one) { return !one.required; }, " and "),
       "false: it may be left empty"},
      {"block.question", "accept", "list of numbers", "two scores", "all",
       "screening, consent and demographics before the first trials: an answer outside [lowest, highest] "
       "ends the session"},
      {"block.question", "stop_at", "whole number", "a score", "never",
       "this score or more ends the session: a rest, then the exit"},
      {"block.question", "expect", "whole number", "a score", where_needed,
       "needed by catch, refused elsewhere: the answer of an attentive participant"},

      {"block.question.anchors", "SCORE", "text", "", where_needed, "the words of this score"},
  };
  return keys;
}

std::string protocol_reference_page() {
  return "# Protocol files, formats 2 and " + std::to_string(Protocol::newest_format) +
         R"(

Written by `vip-study reference`; `vip-study check FILE` checks a file and prints what it describes. Files are
TOML. Units are in the keys: `_s` seconds, `_ms` milliseconds, `_fps` frames per second. An unknown key, a
wrong type, a value out of range and keys that contradict each other are errors at line and column. Every
byte of a file enters the SHA-256 that is stored with the data.

Format 3 describes a study of your own: factors with levels, timing profiles, adaptive procedures. Format
2 has fixed factors (scene, n_*, method, effects, frame rate), as the paper's studies do. To begin, copy a
file from `protocols/` or the example below into a file of your own, change it, and run `vip-study check
FILE` after each change; then `vip-study run FILE --participants 2 --db try.db --observer random --display
none` plays it with simulated people.

## An example

A factor within participants and one between them, in format 3.

```toml
)" + protocol_example() +
         R"(```
)" + base::reference_sections(protocol_tables(), protocol_reference());
}

}  // namespace study
