#pragma once
/// What a participant is shown between stimuli: pages, pauses and the question whether to stop. One a
/// session.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/study/desk/words.hpp"
#include "apps/study/pages/page_surface.hpp"
#include "apps/study/pages/page_view.hpp"
#include "libstudy/session/session.hpp"

namespace apps {

/// All calls on the surface's thread. `clock` is the session's; surface and clock outlive it.
class Pages {
 public:
  Pages(PageSurface& surface, const std::string& language, const study::Clock& clock);

  /// Shows a page until it is confirmed. A wish to stop asks whether it is meant; what then follows comes
  /// through wish().
  std::vector<study::TimedAnswer> run_page(PageText text, std::span<const study::Question> questions,
                                           double least_s, const study::Check& check);
  /// Asks for one of two; true: the first.
  bool choose_first(const DeskChoice& choice, const study::Check& check);
  /// Black until then, with the time left and the words when there are any.
  void wait(const PauseWords& words, std::int64_t until_ns, const study::Check& check);
  /// The words on black, without a time, until `over` is true.
  void show_words(const PauseWords& words, const std::function<bool()>& over, const study::Check& check);
  /// From now on the session is over, or another one begins: over, a wish to stop means nothing.
  void set_over(bool over);

  /// To be asked by the session: what `others` wish, else the end of the session if the participant said so.
  /// A wish to stop during a stimulus asks here; the trial is then over or shown again. It is shown again too
  /// when the stimulus could not be seen, once it can.
  study::Wish wish(const std::function<study::Wish()>& others);

  const DeskWords& words() const { return words_; }
  std::int64_t now_ns() const { return clock_.now_ns(); }
  /// What the first page says on how to answer and to stop.
  std::string beginning() const { return surface_.beginning(words_); }

 private:
  bool handle_events(PageState& state, PageView& view);
  void draw(PageView& view, PageState& state);
  /// True when the participant wishes to stop.
  bool ask_to_stop(const study::Check& check);
  /// One of two on a page above others; none: neither, by a wish to stop.
  std::optional<bool> ask_first(const DeskChoice& choice, const char* layer, const study::Check& check);
  /// Waits a moment; true when the participant wished to stop, and then said so or not.
  bool look_up(double wait_s, const study::Check& check);
  std::string corner() const;
  /// Until it can be seen, or others wish the end.
  study::Wish wait_while_unseen(const std::function<study::Wish()>& others);

  PageSurface& surface_;
  const DeskWords& words_;
  const study::Clock& clock_;
  bool in_page_ = false;  ///< a wish to stop is answered there
  bool stop_wished_ = false;
  bool over_ = false;  ///< see set_over()
  bool away_ = false;  ///< the last wish was a cut for what was not seen: it may still be unseen
};

}  // namespace apps
