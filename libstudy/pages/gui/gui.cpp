#include "libstudy/pages/gui/gui.hpp"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>
#include <vector>

#include "libstudy/pages/page_characters.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace colour {
const unsigned background = IM_COL32(38, 38, 40, 255), panel = IM_COL32(48, 48, 51, 255),
               button = IM_COL32(70, 71, 75, 255), hovered = IM_COL32(90, 92, 97, 255),
               chosen = IM_COL32(38, 112, 186, 255), text = IM_COL32(232, 232, 232, 255),
               dim = IM_COL32(168, 168, 170, 255), faint = IM_COL32(140, 140, 143, 255),
               warning = IM_COL32(236, 168, 92, 255), black = IM_COL32(0, 0, 0, 255);
}  // namespace colour

namespace {

// Heights of the fonts as fractions of the screen's height. Body text is 32 px high on a screen of 1080 px.
constexpr float body_share = 0.0296F, title_share = 0.045F, huge_share = 0.13F;

const ImWchar digits[] = {0x20, 0x3A, 0};

/// Adds the font of find_font() to the atlas, or Dear ImGui's default font if there is none.
ImFont* add_font(ImFontAtlas& atlas, float size, const ImWchar* ranges) {
  const std::string file = find_font();
  ImFontConfig config;
  config.OversampleH = 1;
  config.OversampleV = 1;
  if (!file.empty()) {
    if (ImFont* font = atlas.AddFontFromFileTTF(file.c_str(), size, &config, ranges)) return font;
  }
  config.SizePixels = size;
  return atlas.AddFontDefault(&config);
}

float x_height_of(const ImFont& font) {
  const ImFontGlyph& glyph = *font.FindGlyph('x');
  return glyph.Y1 - glyph.Y0;
}

}  // namespace

TypeSizes type_for_screen(int height_px) {
  const auto height = static_cast<float>(height_px);
  return {std::clamp(std::round(body_share * height), 14.0F, 72.0F),
          std::clamp(std::round(title_share * height), 20.0F, 110.0F),
          std::clamp(std::round(huge_share * height), 40.0F, 300.0F)};
}

TypeSizes type_for_x_height(float x_height_px) {
  constexpr float tried = 100;
  ImFontAtlas atlas;
  const ImWchar letter[] = {'x', 'x', 0};
  const ImFont* font = add_font(atlas, tried, letter);
  atlas.Build();
  // Adds 1 px, because glyphs are rounded to whole pixels.
  const float body = std::ceil(tried * (x_height_px + 1) / x_height_of(*font));
  return {body, std::round(body * title_share / body_share), std::round(body * huge_share / body_share)};
}

Gui::Gui(const TypeSizes& type, Host host, const PageCharacters& characters)
    : host_(std::move(host)), context_(ImGui::CreateContext()), size_px_(type.body) {
  ImGui::SetCurrentContext(context_);
  ImGui::GetIO().IniFilename = nullptr;
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  const PageType letters(characters);
  body_ = letters.add(atlas, type.body);
  title_ = letters.add(atlas, type.title);
  huge_ = add_font(atlas, type.huge, digits);
  atlas.Build();
  ImGui::StyleColorsDark();
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

Gui::~Gui() {
  ImGui::SetCurrentContext(context_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(context_);
}

float Gui::x_height_px() const { return x_height_of(*body_); }

void Gui::begin(unsigned clear_colour) {
  ImGui::SetCurrentContext(context_);
  ImGui_ImplOpenGL3_NewFrame();
  host_.look();
  ImGui::NewFrame();
  const ImVec4 colour = ImGui::ColorConvertU32ToFloat4(clear_colour);
  clear_ = {colour.x, colour.y, colour.z};
  pointed_at_ = 0;
  clear();
}

void Gui::clear() const {
  glBindFramebuffer(GL_FRAMEBUFFER, host_.framebuffer());
  const ImVec2 size = ImGui::GetIO().DisplaySize, scale = ImGui::GetIO().DisplayFramebufferScale;
  glViewport(0, 0, static_cast<int>(size.x * scale.x), static_cast<int>(size.y * scale.y));
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearColor(clear_[0], clear_[1], clear_[2], 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

void Gui::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Gui::dim(float share) {
  ImGui::SetCurrentContext(context_);
  ImDrawData* drawn = ImGui::GetDrawData();
  if (!drawn) return;
  for (float& part : clear_) part *= share;
  const auto dimmed = [share](ImU32 colour, int shift) {
    const auto level = static_cast<float>((colour >> shift) & 0xFFU);
    return static_cast<ImU32>(std::lround(level * share)) << shift;
  };
  for (int i = 0; i < drawn->CmdListsCount; ++i) {
    for (ImDrawVert& vertex : drawn->CmdLists[i]->VtxBuffer) {
      vertex.col = (vertex.col & IM_COL32_A_MASK) | dimmed(vertex.col, IM_COL32_R_SHIFT) |
                   dimmed(vertex.col, IM_COL32_G_SHIFT) | dimmed(vertex.col, IM_COL32_B_SHIFT);
    }
  }
  clear();
  ImGui_ImplOpenGL3_RenderDrawData(drawn);
}

void draw_wrapped(const std::string& words, unsigned colour) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(words.c_str(), words.c_str() + words.size());
  ImGui::PopStyleColor();
}

namespace {

/// True for punctuation that must not begin a line.
bool closes(char32_t c) {
  return std::u32string_view(
             U"\u3001\u3002\uFF0C\uFF0E\uFF1A\uFF1B\uFF1F\uFF01\uFF09\u300B\u300D\u300F\u3011"
             U"\u2019\u201D\u30FC")
             .find(c) != std::u32string_view::npos;
}
/// True for punctuation that must not end a line.
bool opens(char32_t c) {
  return std::u32string_view(U"\uFF08\u300A\u300C\u300E\u3010\u2018\u201C").find(c) !=
         std::u32string_view::npos;
}

/// An unbreakable part of a text. spaced: a space precedes the part.
struct Part {
  std::string text;
  bool spaced = false;
};

/// Splits a text at spaces, and between characters of scripts that are written without spaces.
std::vector<Part> parts_of(const std::string& words) {
  std::vector<Part> out;
  std::istringstream all(words);
  for (std::string word; all >> word;) {
    bool first = true;
    char32_t before = 0;
    for (std::size_t at = 0; at < word.size();) {
      const std::size_t length =
          std::max<std::size_t>(base::utf8_length(std::string_view(word).substr(at)), 1);
      const std::string bytes = word.substr(at, length);
      const char32_t c = characters_of(bytes).front();
      const bool may_break = (breaks_anywhere(c) || breaks_anywhere(before)) && !closes(c) && !opens(before);
      if (first || may_break) out.push_back({"", first});
      out.back().text += bytes;
      first = false;
      before = c;
      at += length;
    }
  }
  return out;
}

}  // namespace

float draw_centred(const std::string& words, ImVec2 at, float width, unsigned colour) {
  std::string line;
  const auto put = [&] {
    const float w = ImGui::CalcTextSize(line.c_str()).x;
    ImGui::GetWindowDrawList()->AddText({std::floor(at.x - w / 2), at.y}, colour, line.c_str());
    at.y += ImGui::GetTextLineHeight();
  };
  for (const Part& part : parts_of(words)) {
    const std::string longer = line.empty() ? part.text : line + (part.spaced ? " " : "") + part.text;
    if (!line.empty() && ImGui::CalcTextSize(longer.c_str()).x > width) {
      put();
      line = part.text;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) put();
  return at.y;
}

namespace {

/// Draws each line of a text centred at at.x; an empty line adds half a line of space. Returns the y below
/// the text.
float draw_paragraphs(const std::string& text, ImVec2 at, float width, unsigned colour) {
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    if (line.empty()) at.y += 0.5F * ImGui::GetTextLineHeight();
    at.y = draw_centred(line, at, width, colour);
  }
  return at.y;
}

/// Draws the time left (null: none), title and text below each other from y down; returns the y below the
/// text.
float draw_pause(const Gui& gui, ImFont* font, const char* left, const PauseWords& words, float y) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float middle = screen.x / 2, column = std::min(0.86F * screen.x, 36 * gui.size_px());
  if (left) {
    ImGui::PushFont(font);
    y = draw_centred(left, {middle, y}, screen.x, colour::dim) + 0.4F * gui.size_px();
    ImGui::PopFont();
  }
  ImGui::PushFont(gui.title());
  y = draw_centred(words.title, {middle, y}, column, colour::dim) + 0.6F * gui.size_px();
  ImGui::PopFont();
  ImGui::PushFont(gui.body());
  y = draw_paragraphs(words.text, {middle, y}, column, colour::dim);
  ImGui::PopFont();
  return y;
}

/// Draws the time left (null: none) and the words in the middle of the window. The digits are small if large
/// digits leave too little space for the words.
void draw_on_black(Gui& gui, const char* left, const PauseWords& words, const std::string& corner) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(screen);
  ImGui::Begin("countdown", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                   (gui.by_hand() ? ImGuiWindowFlags_NoNav : ImGuiWindowFlags_NoInputs));
  // Measures the height by drawing below the window, where nothing is visible.
  const auto height = [&](ImFont* font) {
    return draw_pause(gui, font, left, words, 2 * screen.y) - 2 * screen.y;
  };
  ImFont* const font = height(gui.huge()) < 0.94F * screen.y ? gui.huge() : gui.body();
  draw_pause(gui, font, left, words, std::max(0.03F * screen.y, (screen.y - height(font)) / 2));
  ImGui::PushFont(gui.body());
  draw_corner(gui, corner);
  ImGui::PopFont();
  ImGui::End();
}

}  // namespace

void draw_corner(Gui& gui, const std::string& words) {
  const float size = gui.size_px(), bottom = ImGui::GetIO().DisplaySize.y;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (!gui.by_hand() || words.empty())
    return list.AddText({0.8F * size, bottom - 1.35F * size}, colour::faint, words.c_str());
  const ImVec2 extent = ImGui::CalcTextSize(words.c_str());
  const ImVec2 from{0.6F * size, bottom - 2.6F * size};
  const ImVec2 to{from.x + extent.x + 1.2F * size, from.y + 2 * size};
  ImGui::SetCursorScreenPos(from);
  if (ImGui::InvisibleButton("stop", {to.x - from.x, to.y - from.y})) gui.wish_stop();
  const bool hovered = ImGui::IsItemHovered();
  if (hovered) gui.point_at(ImGui::GetID("stop"));
  list.AddRectFilled(from, to, hovered ? colour::hovered : colour::panel, 0.25F * size);
  list.AddText({from.x + 0.6F * size, from.y + 0.5F * size}, colour::dim, words.c_str());
}

void draw_countdown(Gui& gui, const PauseWords& words, int left_s, const std::string& corner) {
  draw_on_black(gui, fmt::format("{}:{:02}", left_s / 60, left_s % 60).c_str(), words, corner);
}

void draw_words(Gui& gui, const PauseWords& words, const std::string& corner) {
  draw_on_black(gui, nullptr, words, corner);
}

}  // namespace study
