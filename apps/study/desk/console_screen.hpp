#pragma once
/// The experimenter's console as a screen of fixed places.

#include <string>
#include <vector>

namespace apps {

/// What stands on it; texts without line ends.
struct ConsoleView {
  std::string title, clock;
  double done = 0;          ///< share of the session's steps, 0 to 1
  std::string plan;         ///< "step 5 of 44, trial 3; about 12 min left"
  std::string now;          ///< the step under way
  std::string person;       ///< what the participant does
  std::string station;      ///< gaze and disk
  std::string rate, strip;  ///< how the showing goes
  std::string last;         ///< timing of the last trial
  std::vector<std::string> alarms;
  std::vector<std::string> said;  ///< oldest first; as many of the last as there is room for
  std::string typed;              ///< the prompt and what was typed so far
};

/// `rows` lines of at most `columns` columns each; made for 80 x 24, wider and higher ones show more of texts
/// and of `said`. Wide characters (East Asian, pictures) take two columns. columns, rows > 0.
std::vector<std::string> render_console(const ConsoleView& view, int columns, int rows);

}  // namespace apps
