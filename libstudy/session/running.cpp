#include "libstudy/session/running.hpp"

#include "libstudy/session/recording.hpp"

namespace study {

void poll_requests(const Running& run, bool in_trial) {
  const Request request = run.request();
  const std::string news = log_news(run);
  log_tracker(run);
  switch (request.kind) {
    case Request::Stop:
      throw Stopped();
    case Request::EndSession:
      throw Ending{EarlyEnd::Stopped, "ended by the experimenter"};
    case Request::Cut:
      if (in_trial) throw TrialAgain{request.cause, news};
      break;
    case Request::Pause:
    case Request::GoOn:
      break;
  }
}

}  // namespace study
