#include "libstudy/pages/gui/page_fonts.hpp"
#include "libstudy/pages/headset/headset_person.hpp"
#include "stats/base/error.hpp"

namespace study {

HeadsetChoice choice_for_person(const AnswerWays&) {
  throw base::Error("--display openxr", "this build has no pages for a person (it found no Dear ImGui)",
                    "simulate participants with --observer NAME, or install libimgui-dev and build again");
}

HeadsetPerson make_headset_person(HeadsetDisplay&, const AnswerWays& ways, const Protocol&, const Clock&) {
  choice_for_person(ways);
  return {};
}

void check_pages(const Protocol&) {}

}  // namespace study
