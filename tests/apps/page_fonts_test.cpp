/// All characters of a protocol's texts are drawn, or the protocol is refused before a participant sits down.
#include "libstudy/pages/gui/page_fonts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <cstdlib>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/pages/gui/gui.hpp"
#include "libstudy/pages/page_characters.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// The pilot with another question text.
std::string asking(const std::string& words) {
  return replaced(short_protocol("1"),
                  "How satisfied are you with the step speed and the smoothness of the fluid?", words);
}
study::Protocol protocol_asking(const std::string& words) {
  return study::parse_protocol(asking(words), "asking.toml");
}

TEST(PageFonts, EveryShippedProtocolIsDrawn) {
  for (const auto& entry : fs::directory_iterator(base::resource("protocols"))) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(study::check_pages(study::read_protocol(entry.path()))) << entry.path();
  }
}

TEST(PageFonts, AccentsGreekCyrillicAndSignsAreDrawn) {
  EXPECT_NO_THROW(study::check_pages(protocol_asking("Été, Größe, αβγ, Вы видели?, Łódź, 3 ≤ 5 → ☃ Վ")));
}

TEST(PageFonts, ScriptsThatWouldBeDrawnWronglyAreRefusedWithTheReason) {
  const std::pair<const char*, const char*> refused[] = {
      {"هل أنت راض؟", "right to left"},      {"האם אתה מרוצה?", "right to left"},
      {"क्या आप संतुष्ट हैं?", "neighbours"},      {"คุณพอใจไหม", "neighbours"},
      {"Zu\u0308rich", "beside the letter"}, {"smo\u200Bothness", "cannot be seen"},
      {"Good \U0001F600?", "beyond U+FFFF"}};
  for (const auto& [words, reason] : refused) {
    EXPECT_THAT([&] { study::check_pages(protocol_asking(words)); },
                ThrowsMessage<base::Error>(AllOf(HasSubstr("asking.toml: block 'ratings', question "
                                                           "'satisfaction', text: the character U+"),
                                                 HasSubstr(reason), HasSubstr("mend: "))))
        << words;
  }
}

// Characters that the usual font lacks are drawn from another font that has them.
TEST(PageFonts, CharactersOfTheProtocolComeIntoTheAtlas) {
  const study::PageType type(study::page_characters(protocol_asking("☃ snow?")));
  ImFontAtlas atlas;
  const ImFont* const font = type.add(atlas, 20);
  atlas.Build();
  EXPECT_NE(font->FindGlyphNoFallback(u'☃'), nullptr);
  EXPECT_EQ(type.undrawn(U"☃a"), U"");
  EXPECT_EQ(study::PageType({}).undrawn(U"☃a"), U"☃");
}

TEST(PageFonts, AChosenFontThatIsNotThereIsAnError) {
  ::unsetenv("VIP_FONT");
  const std::string usual = study::find_font();
  ::setenv("VIP_FONT", "", 1);
  EXPECT_EQ(study::find_font(), usual);
  ::setenv("VIP_FONT", "/no/such/font.ttf", 1);
  EXPECT_THAT([] { study::find_font(); },
              ThrowsMessage<base::Error>(
                  AllOf(HasSubstr("VIP_FONT = /no/such/font.ttf"), HasSubstr("is not a file"))));
  ::unsetenv("VIP_FONT");
}

// Chinese has no spaces: lines break between characters, and no punctuation mark starts a line.
TEST(PageFontsGl, WordsWithoutSpacesAreWrapped) {
  const sim::GlContext gl = sim::GlContext::make_headless();
  const sim::Offscreen picture(400, 300);
  study::Gui gui(study::type_for_screen(600), {[] {
                                                 ImGui::GetIO().DisplaySize = {400, 300};
                                               },
                                               [&picture] { return picture.framebuffer(); }});
  gui.begin(study::colour::background);
  ImGui::PushFont(gui.body());
  ImGui::Begin("page");
  const float one = study::draw_centred("中", {200, 0}, 100, study::colour::text);
  EXPECT_GE(
      study::draw_centred("中中中中中中中中中中中中中中中中中中中中", {200, 0}, 100, study::colour::text),
      2 * one);
  EXPECT_EQ(study::draw_centred("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", {200, 0}, 100, study::colour::text), one);
  ImGui::End();
  ImGui::PopFont();
  gui.end();
}

class PageFontsE2e : public ::testing::Test {
 protected:
  PageFontsE2e() {
    base::write_file_atomically(folder_ / "chinese.toml", asking("您对刚才看到的画面满意吗？"));
    // A system whose only fonts are those of DejaVu.
    base::write_file_atomically(
        folder_ / "fonts.conf",
        "<?xml version=\"1.0\"?><!DOCTYPE fontconfig SYSTEM \"fonts.dtd\"><fontconfig>"
        "<dir>/usr/share/fonts/truetype/dejavu</dir><cachedir>" +
            (folder_ / "cache").string() + "</cachedir></fontconfig>");
  }
  Ended without_fonts(std::vector<std::string> arguments) const {
    return run_program(arguments, [this] {
      ::setenv("FONTCONFIG_FILE", (folder_ / "fonts.conf").c_str(), 1);
      ::unsetenv("VIP_FONT");
    });
  }
  TemporaryFolder folder_;
};

TEST_F(PageFontsE2e, CheckAndRunRefuseWhatNoFontDraws) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{vip_study, "check", folder_ / "chinese.toml"},
        std::vector<std::string>{vip_study, "run", folder_ / "chinese.toml", "--db", folder_ / "s.db",
                                 "--participant", "P01"}}) {
    const Ended ended = without_fonts(arguments);
    EXPECT_EQ(ended.exit_code, 1) << ended.out;
    EXPECT_THAT(ended.err,
                AllOf(HasSubstr("question 'satisfaction', text: no font of this computer draws the character "
                                "U+60A8 (您), nor 12 others"),
                      HasSubstr("apt-get install fonts-noto-cjk")));
    EXPECT_FALSE(fs::exists(folder_ / "s.db"));
  }
  // An observer reads no pages, so no fonts are needed.
  const Ended observer = without_fonts(run_arguments(folder_ / "chinese.toml", folder_ / "s.db",
                                                     {"--participant", "P01", "--clock", "virtual"}));
  EXPECT_EQ(observer.exit_code, 0) << observer.err;
}

}  // namespace
}  // namespace apps::test
