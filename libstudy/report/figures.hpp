#pragma once
/// The page's figures, each from a part of the results.

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "libstudy/report/field.hpp"
#include "stats/figures/svg.hpp"

namespace study::report {

/// Width in pixels to reserve for the longest of these names, at a font size of 13 pixels. Only the browser
/// knows the true width; 8 pixels a letter exceed the average of sans-serif fonts.
inline double room_for(const std::vector<std::string>& names) {
  std::ptrdiff_t longest = 0;
  for (const std::string& name : names)
    longest = std::max(longest, std::count_if(name.begin(), name.end(), [](char byte) {
                         return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;  // first byte of a letter
                       }));
  return 8.0 * static_cast<double>(longest);
}

/// Elements of a picture, moved to the right by `px`.
inline std::string moved_right(const std::string& elements, double px) {
  return "<g transform=\"translate(" + svg::number(px, 0) + " 0)\">\n" + elements + "</g>\n";
}

/// One score of Task 1 as in the paper's Fig. 9: within each n_* a box for each method with an X at its mean,
/// and brackets with stars over pairs that differ. `score`: an entry of task1.scores.
svg::Picture box_plot(const Field& task1, const Field& score);

/// One score of Task 1: a line for each participant over the methods, within each n_*, and the mean.
svg::Picture person_lines(const Field& task1, const Field& score);

/// One score of Task 1: the mean of each method in each scene, with its interval, within each n_*.
svg::Picture scene_lines(const Field& task1, const Field& score);

/// A bar for each entry of a list of distributions: how often each score was given. `names`: of the bars.
svg::Picture rating_bars(const std::vector<Field>& entries, const std::vector<std::string>& names,
                         const std::string& id, const std::string& title);

/// The share that a pair's test is about: of answers, or over people if they answered several times.
inline Field tested_share(const Field& pair) {
  return pair["by_person"].exists() ? pair["by_person"]["share"] : pair["share"];
}

/// Task 2 as in the paper's Fig. 10: how often each of a pair was chosen, with the interval of the share.
svg::Picture preference_bars(const Field& pairs);

/// Timing verdicts of each method's showings, over scenes, if one was degraded or failed.
svg::Picture timing_chart(const Field& timing, const std::string& task);

/// Flow chart of participants in CONSORT style. `flow`: flow.task1 or flow.task2.
svg::Picture flow_chart(const Field& flow, const std::string& id, const std::string& task);

/// FMS at each time of asking: quartiles, median, mean and largest. `fms`: "fms" of an entry of sickness.
svg::Picture fms_chart(const Field& fms, const std::string& id);

/// The pilot's heat map (paper Fig. 6). `pilot`: as written by fit-ptpe; its estimates must be present.
svg::Picture pilot_map(const Field& pilot);

}  // namespace study::report
