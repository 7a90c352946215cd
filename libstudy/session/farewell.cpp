#include "libstudy/session/farewell.hpp"

#include <algorithm>

#include "libstudy/store/withdraw.hpp"

namespace study {

namespace {

// Shortest rest after a stop if stimuli were shown, s. The page then asks participants to stay until they
// feel well.
constexpr double stop_rest_s = 60;

class Farewell {
 public:
  Farewell(const Running& run, Questioning& questioning) : run_(run), questioning_(questioning) {}

  void tell(Notice notice, double least_s = 0) {
    run_.parts.participant.tell(notice, least_s, run_.parts.clock, check_);
  }

  void after_stop(std::span<const OpenUnit> left) {
    Store& store = run_.parts.store;
    const bool shown = store.has_shown(run_.session.id);
    tell(Notice::Over, shown ? stop_rest_s : 0);
    if (shown) ask_how_they_feel(left);
    if (!store.has_answers(run_.session.id)) return tell(Notice::Goodbye);
    const bool keep = offer(Offer::Keep);
    if (!keep) store.log(run_.session.id, withdrawal_request, "of the participant", run_.now_ns());
    tell(keep ? Notice::Kept : Notice::Deleted);
  }

 private:
  bool offer(Offer what) { return run_.parts.participant.offer(what, run_.parts.clock, check_); }

  /// Offers the last SSQ page that is not done. Every item is optional, so that participants who feel unwell
  /// can leave at once.
  void ask_how_they_feel(std::span<const OpenUnit> left) {
    const auto last = std::find_if(left.rbegin(), left.rend(), [this](const OpenUnit& unit) {
      return run_.block(unit).kind == BlockKind::Ssq;
    });
    if (last == left.rend() || !offer(Offer::Questionnaire)) return;
    std::vector<Question> items = run_.block(*last).questions;
    for (Question& item : items) item.required = false;
    questioning_.ask(*last, 0, items, run_.occasion(*last), true, check_);
  }

  const Running& run_;
  Questioning& questioning_;
  Check check_ = [this] {
    if (run_.request() == Request::Stop) throw Stopped();
  };
};

}  // namespace

void say_farewell(const Running& run, Questioning& questioning, const Ending& ending,
                  std::span<const OpenUnit> left) {
  Farewell farewell(run, questioning);
  try {
    switch (ending.how) {
      case EarlyEnd::Refused:
        return farewell.tell(Notice::Refused);
      case EarlyEnd::NotEligible:
        return farewell.tell(Notice::NotEligible);
      case EarlyEnd::Stopped:
        return farewell.after_stop(left);
      case EarlyEnd::DroppedOut:
        return;
    }
  } catch (const Stopped&) {  // skips the remaining pages; the end of the session is already stored
  }
}

}  // namespace study
