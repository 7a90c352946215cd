/// The sections of the reference of protocols.
#include "libstudy/protocol/reference.hpp"

namespace study {

const std::vector<base::TableReference>& protocol_tables() {
  static const std::vector<base::TableReference> tables{
      {"", "The file itself", "Stands before the first table."},
      {"stimulus", "[stimulus]",
       R"(Format 3: what each stimulus shows unless a level of a factor sets it. Each key must be set here or by
the levels of one factor, except effects and surface.)"},
      {"stimulus.timing", "timing",
       R"(How long each frame stays on. `profile` selects the keys:

| profile | the frames | its keys |
|---|---|---|
| moments | a mean and a standard deviation, timed by [pacing] | mean_fps, sd_fps |
| hitches | a steady rate; in each period one frame stays on longer | base_fps, hitch_ms, period_s, jitter |
| floor | one frame in 20 lasts 1/low_fps, the others share the rest of the time evenly ("5 % low") | mean_fps, low_fps |
| trace | recorded frame times in their order, repeated or cut to duration_s | frame_ms, smoothed |

A display with a fixed refresh moves each frame to the nearest of its periods; `vip-study check` says what
remains. latency_ms and animation_error_ms go with each profile and need `content.mode = "real_time"`.)"},
      {"factor", "[[factor]]",
       "Format 3: an experimental factor. Without `combination` all levels are crossed, which makes the "
       "cells."},
      {"factor.level", "[[factor.level]]",
       R"(A level: its name, and what it shows. It sets keys as [stimulus] has them: scene, method, n_star, effects,
surface, timing. All levels of a factor set the same keys, and no other factor sets them.)"},
      {"procedure", "[procedure]",
       R"(Format 3: adaptive trials. A track is a sequence of trials that differ only in the level of `factor`; each
combination of the other within-subject levels has its own track, and tracks are interleaved at random.
What was chosen is never stored as a state: it follows from the answers, so a resumed session continues
exactly.

| kind | the next level | its keys |
|---|---|---|
| staircase | one step down after `down_after` positive answers in a row, up after `up_after` others (Levitt 1971); with up_ratio a weighted rule (Kaernbach 1991) | axis, positive, start, steps, down_after, up_after, up_ratio, fast_start |
| quest_plus | the level whose answer is expected to say most about threshold, slope and lapse rate (Watson 2017) | axis, positive, form, guess, lapse, fixed, most_of_one |
| ptpe | a frame rate near the contour that all ratings so far suggest, above, on and below it in turn, three of four at the smallest standard deviation and one at the largest | fixed, most_of_one |

The threshold is a point of the psychometric function, which rises from guess to 1 - lapse: with form
weibull the level at 63 % (1 - 1/e) of this rise, with normal and logistic the level at half of it. The
shape is the exponent of the Weibull function, the standard deviation of the normal one, the scale of the
logistic one.

`fixed` trials come first: they keep checks of the model possible. A session has no block
of kind repeat then; catch pages are possible.)"},
      {"combination", "[[combination]]",
       "Format 3: one cell each, instead of all combinations. Every level occurs at least once."},
      {"design", "[design]",
       R"(What is shown, and in which order. Format 3 has the keys duration_s, repetitions, pairs, standard,
order, never_adjacent, assignment, overlay and effect_set; its cells are the combinations of the levels. A
participant meets all cells with one level of each between-subject factor. Those levels are dealt by quota.

Format 2 has fixed factors. Every scene, n_*, method and level of effects, and under `settings`
every pair of moments with sd_fps below mean_fps, make one cell. Cells of one scene and n_* are a group; a
participant meets `groups` of them, one after another.)"},
      {"design.standard", "standard",
       R"(The standard of two-interval trials, as in `standard = {hitch = "none"}`. A cell is compared with the
standard that has the same level of every within-subject factor that `standard` does not name. So `standard =
{surface = "spheres"}` compares two surfaces at each scene and method, and never two scenes.)"},
      {"design.moments", "[[design.moments]]",
       R"(The frame rate of one cell each, for `timing = "table2"`; without effect under native and equal.)"},
      {"design.effect_set", "[[design.effect_set]]",
       R"(What a level of `effects` holds: these effects and no others, whatever the scene lists besides. Effects of
the picture, such as `shadows`, vary where a set names one, so that level none has none of them.
Else they stay at every level as the scene lists them, none included.)"},
      {"design.effect_set.effect", "[[design.effect_set.effect]]",
       R"(An effect with its coefficient and options, as `[[effect]]` in a scene file
([methods.md](methods.md#effects)).)"},
      {"pacing", "[pacing]", "How a mean and a standard deviation become the intervals of frames."},
      {"content", "[content]", "How the process elapses with the frames."},
      {"timing", "[timing]", "What a trial must meet to pass. The table may be left out."},
      {"headset", "[headset]", "How a headset shows the stimuli. The table may be left out."},
      {"block", "[[block]]", R"(The blocks of a session in their order. Kinds:

| kind | what it is |
|---|---|
| instructions | a text to be read |
| screening | questions that may rule a person out |
| consent | a text with boxes; one of its questions has `accept`. A refusal is asked once more, then the session is over |
| demographics | questions, as a rule personal |
| practice | trials that are flagged, never dropped |
| stimulus | the trials of the design; exactly one block |
| question | questions outside the trials |
| rest | a pause with a countdown that nobody can cut short |
| break | a pause that ends when the participant wishes, not before its seconds |
| black | a black screen |
| repeat | trials shown again, with the very same intervals: test-retest |
| catch | pages after trials drawn at random, with an answer that attention gives |
| ssq | Simulator Sickness Questionnaire (Kennedy et al. 1993): ids ssq_1 to ssq_16, 0 to 3 |
| gaze_validation | nine targets to look at, each for 1.8 s: how well a headset's eye tracker does |
| fms | Fast Motion Sickness scale (Keshavarz and Hecht 2011): id fms, 0 to 20 |
| debrief | the last text |

Exports and report hold the scores of the SSQ, and the mean and the peak of the FMS.)"},
      {"block.question", "[[block.question]]",
       R"(The questions of a block: on its page, or for a stimulus block in its steps. They come after the keys
of its block. Blocks of kind screening, consent, demographics, stimulus, question and catch have at least one.

Two ids are reserved for questions whose answers the program acts on. They belong in a block of kind consent,
with `kind = "yes_no"`, or a choice of 0 (no) and 1 (yes), and not personal:

- `gaze_kept`: may gaze and head movement be recorded. No row of gaze is written unless it
  was answered with 1; a protocol that does not ask records none.
- `data_shared`: may the data be part of public exports (BIDS, Psych-DS). Whoever answered 0, or was asked
  and has not answered, is left out of them whole. People who were never asked are included.

`vip-study consent` changes both later.

A `vas` shows no number, no tick and no mark until the participant sets one: by mouse, ray or gaze, or by
arrow keys, 1 % of the line at a time (up, down, page up, page down, and left and right with shift: 10 %). The
first key sets it at an end.

A `reaction` is alone on its page. The page is the cue, and any key, mouse button, button of a gamepad or
trigger ends it. Its response time counts from when the page's first frame was handed to the display; an
answer 0 has `timeout_s`. A page that was out of sight, or under the question whether to stop, begins anew.
The time also holds the delay of the display, a frame or more, and that of the device: the program knows
neither. In a window a key or mouse button is taken when its event comes, and a gamepad is read every 2 ms; a
headset gives its input once a frame. None of this was measured. So compare conditions at one station, and
measure its delay if the times themselves matter.

`vip-stats` finds what it analyses by these questions of the stimulus block. Other questions are exported and
may stand beside them.

| study | needs | and uses |
|---|---|---|
| pilot: one method at several frame rates | a question of kind scale or vas; `vip-stats fit-ptpe --question ID` takes one of several | |
| Task 1: methods shown one by one | `realism`, of kind scale or vas; for hypotheses about methods also `disorientation`, `unrealism`, `dizziness` and `confusion`, on one scale | |
| Task 2: pairs | a question of kind choice with two anchors or yes_no, the lower one for the first interval | |
| all | | questions of kind number, choice, yes_no, scale and vas in blocks of kind demographics, screening and question, such as `age` and `gender`, unless a trial asks them too: the report gives the answers in summary |)"},
      {"block.question.anchors", "anchors",
       R"(Words by score, as in `anchors = {1 = "poor", 7 = "good"}`.)"}};
  return tables;
}

const std::string& protocol_example() {
  static const std::string text = R"(format = 3
name = "lag"
version = "1.0"
language = "en"
participants = 20

[stimulus]                       # what every stimulus shows unless a level sets it
method = "HiRes"
n_star = "8k"

[[factor]]                       # each participant sees all its levels
name = "lag"
vary = "within"
[[factor.level]]
name = "none"
timing = {profile = "moments", mean_fps = 60}
[[factor.level]]
name = "lag100"
timing = {profile = "moments", mean_fps = 60, latency_ms = 100}

[[factor]]                       # each participant sees one of its levels, dealt by quota
name = "content"
vary = "between"
[[factor.level]]
name = "dam"
scene = "data/scenes/single_dam.toml"
[[factor.level]]
name = "drop"
scene = "data/scenes/droplet.toml"

[design]
duration_s = 4
repetitions = 5
order = "shuffle"

[pacing]
fps_min = 4
max_interval_ms = 250

[content]
mode = "real_time"
content_step_s = 0.008333333333333333
start_frame = 0
at_end = "loop"

[[block]]
kind = "consent"
id = "consent"
text = "Your answers are stored without your name."
[[block.question]]
id = "take_part"
kind = "choice"
text = "I would like to take part."
anchors = {0 = "no", 1 = "yes"}
accept = [1, 1]

[[block]]
kind = "stimulus"
id = "trials"
steps = ["black 1", "stimulus", "ask delayed"]
[[block.question]]
id = "delayed"
kind = "choice"
text = "Did the water seem delayed?"
anchors = {0 = "no", 1 = "yes"}
)";
  return text;
}

}  // namespace study
