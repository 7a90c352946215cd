#include "libstudy/pages/headset/headset_person.hpp"

#include "libstudy/pages/gui/page_participant.hpp"
#include "libstudy/pages/headset/headset_surface.hpp"

namespace study {

namespace {

/// Owns the surface and its pages while either is referenced.
struct HeadsetPages {
  HeadsetPages(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol, const Clock& clock)
      : surface(display, ways, page_characters(protocol)), pages(surface, protocol.language, clock) {}
  HeadsetSurface surface;
  Pages pages;
};

}  // namespace

HeadsetChoice choice_for_person(const AnswerWays& ways) { return choice_for_pages(ways); }

HeadsetPerson make_headset_person(HeadsetDisplay& display, const AnswerWays& ways, const Protocol& protocol,
                                  const Clock& clock) {
  const auto both = std::make_shared<HeadsetPages>(display, ways, protocol, clock);
  const std::shared_ptr<Pages> pages(both, &both->pages);
  HeadsetPerson person;
  person.participant = std::make_unique<PageParticipant>(pages, protocol.blocks.back().id, [] {});
  person.request = [pages](const std::function<Request()>& others) { return pages->request(others); };
  person.idle = [both] { return both->surface.idle_s(); };
  person.listen = [both] { both->surface.listen(); };
  return person;
}

}  // namespace study
