#pragma once
/// A person who answers on pages.

#include <memory>

#include "libstudy/pages/gui/pages.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

class PageParticipant final : public Participant {
 public:
  /// last_block: id of the protocol's last block. before_stimulus: called shortly before the end of each
  /// black pause, since a stimulus may follow.
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
  /// The texts of a block's page: the first page of a session says how to stop, the last one that it ends.
  PageText page_of(const Block& block);

  std::shared_ptr<Pages> pages_;
  std::string last_block_;
  bool begun_ = false;  ///< a page of the session was shown
  std::function<void()> before_stimulus_;
};

}  // namespace study
