#include "libstudy/session/running.hpp"

#include "libstudy/session/recording.hpp"

namespace study {

void heed(const Running& run, bool in_trial) {
  const Wish wish = run.wish();
  const std::string news = log_news(run);
  switch (wish.kind) {
    case Wish::Stop:
      throw Stopped();
    case Wish::EndSession:
      throw Ending{EarlyEnd::Stopped, "ended by the experimenter"};
    case Wish::Cut:
      if (in_trial) throw TrialAgain{wish.cause, news};
      break;
    case Wish::Pause:
    case Wish::GoOn:
      break;
  }
}

}  // namespace study
