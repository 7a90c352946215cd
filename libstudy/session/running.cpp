#include "libstudy/session/running.hpp"

#include "libstudy/session/recording.hpp"

namespace study {

void heed(const Running& run, bool in_trial) {
  const Wish wish = run.wish();
  const std::string news = log_news(run);
  switch (wish) {
    case Wish::Stop:
      throw Stopped();
    case Wish::EndSession:
      throw Ending{EarlyEnd::Stopped, "ended by the experimenter"};
    case Wish::RepeatTrial:
      if (in_trial) throw TrialAgain{"wish of the experimenter"};
      break;
    case Wish::NotShown:
      if (in_trial) throw TrialAgain{"the screen did not show it" + (news.empty() ? news : ": " + news)};
      break;
    case Wish::Pause:
    case Wish::GoOn:
      break;
  }
}

}  // namespace study
