#pragma once
/// The experimenter's console as a screen with a fixed layout.

#include <string>
#include <vector>

namespace study {

/// The content of the screen. No text contains a line end.
struct ConsoleView {
  std::string title, clock;
  double done = 0;          ///< fraction of the session's steps that are done, 0 to 1
  std::string plan;         ///< "5 of 44 steps done; left: about 12 min"
  std::string now;          ///< the current step: "step 6 of 44: stimulus 'task', trial 3"
  std::string person;       ///< what the participant does
  std::string station;      ///< gaze source, free disk space and the station's name
  std::string rate, strip;  ///< the current showing: timing in numbers; a strip_sign() per half second
  std::string last;         ///< timing verdicts on the trial that finished last
  std::vector<std::string> alarms;
  std::vector<std::string> said;  ///< messages, oldest first; the newest that fit are shown
  std::string typed;              ///< the prompt and the text typed so far
};

/// Returns `rows` lines of at most `columns` columns. Designed for 80 x 24; larger screens show longer texts
/// and more messages. Wide characters (East Asian, emoji) take two columns. columns, rows > 0.
std::vector<std::string> render_console(const ConsoleView& view, int columns, int rows);

}  // namespace study
