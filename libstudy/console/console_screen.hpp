#pragma once
/// The experimenter's console as a screen with a fixed layout.

#include <string>
#include <vector>

namespace study {

/// The content of the screen; texts without line ends.
struct ConsoleView {
  std::string title, clock;
  double done = 0;          ///< fraction of the session's steps, 0 to 1
  std::string plan;         ///< "step 5 of 44, trial 3; about 12 min left"
  std::string now;          ///< the current step
  std::string person;       ///< what the participant does
  std::string station;      ///< gaze and disk
  std::string rate, strip;  ///< timing of the current showing
  std::string last;         ///< timing of the last trial
  std::vector<std::string> alarms;
  std::vector<std::string> said;  ///< oldest first; the last ones are shown as far as there is room
  std::string typed;              ///< the prompt and the text typed so far
};

/// `rows` lines of at most `columns` columns; designed for 80 x 24, larger screens show more of the texts and
/// of `said`. Wide characters (East Asian, pictures) take two columns. columns, rows > 0.
std::vector<std::string> render_console(const ConsoleView& view, int columns, int rows);

}  // namespace study
