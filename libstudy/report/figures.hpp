#pragma once
/// Draws the figures of the page from parts of the results.

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "libstudy/report/field.hpp"
#include "stats/figures/svg.hpp"

namespace study::report {

/// Width in pixels that is reserved for the longest of the names, at a font size of 13 pixels. It assumes 8
/// pixels for each letter, more than the average of sans-serif fonts, since only the browser knows the true
/// width.
inline double room_for(const std::vector<std::string>& names) {
  std::ptrdiff_t longest = 0;
  for (const std::string& name : names)
    longest = std::max(longest, std::count_if(name.begin(), name.end(), [](char byte) {
                         return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;  // starts a letter
                       }));
  return 8.0 * static_cast<double>(longest);
}

/// Elements of a picture, moved to the right by `px` pixels.
inline std::string moved_right(const std::string& elements, double px) {
  return "<g transform=\"translate(" + svg::number(px, 0) + " 0)\">\n" + elements + "</g>\n";
}

/// One score of Task 1 as in the paper's Fig. 9. For each n_* and method it has a box with an X at the mean.
/// Brackets with stars connect methods that differ. `score`: an entry of task1.scores.
svg::Picture box_plot(const Field& task1, const Field& score);

/// One score of Task 1: for each n_*, a line over the methods for each participant, and a line of means.
svg::Picture person_lines(const Field& task1, const Field& score);

/// One score of Task 1: for each n_* and scene, a line of the methods' means with confidence intervals.
svg::Picture scene_lines(const Field& task1, const Field& score);

/// A bar for each distribution in `entries`, divided by the shares of the scores. `names`: names of the bars.
svg::Picture rating_bars(const std::vector<Field>& entries, const std::vector<std::string>& names,
                         const std::string& id, const std::string& title);

/// The share that a pair's test compares with one half. It is the share of the answers, or, if some people
/// answered the pair several times, the mean of the people's shares.
inline Field tested_share(const Field& pair) {
  return pair["by_person"].exists() ? pair["by_person"]["share"] : pair["share"];
}

/// Task 2 as in the paper's Fig. 10: for each pair, the share of choices of each method, with a confidence
/// interval.
svg::Picture preference_bars(const Field& pairs);

/// Shares of timing verdicts over the showings of each method at each n_* (pilot: of each frame-rate
/// setting), only for methods (settings) with a degraded or failed showing.
svg::Picture timing_chart(const Field& timing, const std::string& task);

/// Flow chart of participants in CONSORT style. `flow`: an entry of "flow", such as flow.task1.
svg::Picture flow_chart(const Field& flow, const std::string& id, const std::string& task);

/// FMS scores at the first, second, ... time of asking: quartiles, median, mean and largest. `fms`: member
/// "fms" of an entry of "sickness".
svg::Picture fms_chart(const Field& fms, const std::string& id);

/// The share of positive answers of all participants at each level, with the mean psychometric function.
/// `thresholds`: the entry "thresholds" of a study's results; `track`: an entry of its list "tracks".
svg::Picture psychometric_chart(const Field& thresholds, const Field& track, const std::string& id);

/// A row for each cell of a study with factors: its mean over participants with the interval. `question`: an
/// entry of the results' list "descriptives", with at least one cell.
svg::Picture cell_means_chart(const Field& question, const std::string& id);

/// The pilot's heat map (paper Fig. 6). `pilot`: the entry "pilot" of the results, with estimates.
svg::Picture pilot_map(const Field& pilot);

}  // namespace study::report
