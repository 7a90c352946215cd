#pragma once
/// The screens between stimuli (pages, pauses and the stop dialog), and the participant who answers on these
/// pages.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/pages/gui/page_surface.hpp"
#include "libstudy/pages/gui/page_view.hpp"
#include "libstudy/pages/words.hpp"
#include "libstudy/session/participant.hpp"
#include "libstudy/session/session.hpp"

namespace study {

/// The screens of a session. All calls come from the surface's thread. `clock` is the session's clock.
/// Surface and clock must outlive the object. `check` of the functions below is called often while they wait;
/// it throws to end the wait.
class Pages {
 public:
  Pages(PageSurface& surface, const std::string& language, const Clock& clock);

  /// Shows a page until it is confirmed. A request to stop opens the stop dialog. If the participant then
  /// stops, request() returns the end of the session. shown: called once the page is on the surface.
  std::vector<TimedAnswer> run_page(PageText text, std::span<const Question> questions, double least_s,
                                    const Check& check, const std::function<void()>& shown = {});
  /// Shows a page with a choice of two answers; true if the first was chosen.
  bool choose_first(const DeskChoice& choice, const Check& check);
  /// Shows black until until_ns; with `words`, shows them and the time left instead.
  void wait(const PauseWords& words, std::int64_t until_ns, const Check& check);
  /// Shows the words on black, without the time left, until `over` returns true.
  void show_words(const PauseWords& words, const std::function<bool()>& over, const Check& check);
  /// Call it when the session is over (true) or another session begins (false). After `true`, requests to
  /// stop are ignored.
  void set_over(bool over);

  /// The session calls this function repeatedly (SessionHooks::request). Returns the request of `others`, or
  /// the end of the session if the participant stopped. A request to stop during a stimulus opens the stop
  /// dialog here; afterwards the session ends, or the trial is cut and shown again. A trial is also cut if
  /// its stimulus could not be seen; the next call then waits until the surface is visible, and the trial is
  /// shown again.
  Request request(const std::function<Request()>& others);

  const DeskWords& words() const { return words_; }
  std::int64_t now_ns() const { return clock_.now_ns(); }
  /// Text about how to answer and how to stop, for the first page of a session.
  std::string beginning() const { return surface_.beginning(words_); }

 private:
  bool handle_events(PageState& state, PageView& view);
  void draw(PageView& view, PageState& state);
  /// Opens the stop dialog; true if the participant wants to stop.
  bool ask_to_stop(const Check& check);
  /// Shows a choice of two answers above other pages; true if the first was chosen. None: the participant
  /// closed the choice with another request to stop.
  std::optional<bool> ask_first(const DeskChoice& choice, const char* layer, const Check& check);
  /// Waits for wait_s and processes input; true if the stop dialog was opened.
  bool look_up(double wait_s, const Check& check);
  std::string corner() const;
  /// Waits until the surface can be seen, or until `others` requests the end of the session.
  Request wait_while_unseen(const std::function<Request()>& others);

  PageSurface& surface_;
  const DeskWords& words_;
  const Clock& clock_;
  bool in_page_ = false;  ///< true: a page is shown and handles requests to stop
  bool stop_requested_ = false;
  bool over_ = false;
  bool away_ = false;  ///< the last request was a cut because the surface was not visible
};

/// A person who answers on pages.
class PageParticipant final : public Participant {
 public:
  /// last_block: id of the protocol's last block. before_stimulus: called shortly before the end of each
  /// black pause, because a stimulus may follow.
  PageParticipant(std::shared_ptr<Pages> pages, std::string last_block, std::function<void()> before_stimulus)
      : pages_(std::move(pages)),
        last_block_(std::move(last_block)),
        before_stimulus_(std::move(before_stimulus)) {}

  std::optional<std::string> simulated() const override { return {}; }
  void read(const Block& block, double least_s, Clock& clock, const Check& check) override;
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) override;
  void pause(const Pause& pause, Clock& clock, const Check& check) override;
  void tell(Notice notice, double least_s, Clock& clock, const Check& check) override;
  bool offer(Offer offer, Clock& clock, const Check& check) override;

 private:
  /// The texts of a block's page. The session's first page says how to stop; the button of the last page says
  /// Finish.
  PageText page_of(const Block& block);

  std::shared_ptr<Pages> pages_;
  std::string last_block_;
  bool begun_ = false;  ///< a page of the session was shown
  std::function<void()> before_stimulus_;
};

}  // namespace study
