#include "libstudy/pages/gui/page_view.hpp"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>

#include "libstudy/console/console_text.hpp"

namespace study {

namespace {

using study::AnswerKind;
using study::Question;

constexpr ImGuiWindowFlags plain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
                                   ImGuiWindowFlags_NoNav;
/// This many or more consecutive questions with equal layout are drawn as a table.
constexpr std::size_t fewest_rows = 3;

bool looks_like(const Question& a, const Question& b) {
  return a.kind == AnswerKind::Scale && b.kind == AnswerKind::Scale && a.scale_min == b.scale_min &&
         a.scale_max == b.scale_max && a.anchors == b.anchors;
}

/// The index after the last of the consecutive questions with the layout of question `first`; first + 1 if
/// these questions are too few for a table.
std::size_t end_of_table(const PageState& state, std::size_t first) {
  std::size_t end = first + 1;
  while (end < state.size() && looks_like(state.question(first), state.question(end))) ++end;
  return end - first >= fewest_rows ? end : first + 1;
}

/// The keys that choose yes (first) and no in a YesNo, as capital letters. Empty if an answer has no key.
std::pair<std::string, std::string> keys_of(const Question& question) {
  auto keys = std::pair{letter_of(question, 1), letter_of(question, 0)};
  for (std::string* key : {&keys.first, &keys.second})
    for (char& letter : *key) letter = static_cast<char>(letter - 'a' + 'A');
  return keys.first.empty() || keys.second.empty() ? decltype(keys)() : keys;
}

}  // namespace

bool PageView::fills_words(const PageState& state) {
  return state.focus() < state.size() && !traits_of(state.question(state.focus()).kind).scored;
}

bool PageView::typing(const PageState& state) const { return !gui_.by_hand() && fills_words(state); }

Pad* PageView::pad_of(const PageState& state) {
  if (!gui_.by_hand() || state.focus() == state.size()) return nullptr;
  const Question& question = state.question(state.focus());
  if (traits_of(question.kind).listed) return nullptr;
  if (!pad_ || pad_question_ != state.focus()) pad_.emplace(question);
  pad_question_ = state.focus();
  return &*pad_;
}

void PageView::press(PageState& state, PageKey key, std::int64_t now_ns) {
  Pad* pad = pad_of(state);
  if (!pad || !pad->press(key, state, now_ns)) state.press(key, now_ns);
}

void PageView::draw(PageState& state, std::int64_t now_ns) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float size = gui_.size_px();
  column_ = std::min(0.86F * screen.x, 36 * size);
  look_at_mouse(!state.guarded(now_ns));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(screen);
  ImGui::PushFont(gui_.body());
  ImGui::Begin("page", nullptr, plain);
  const float top = 1.4F * size, bottom = screen.y - 5.4F * size;
  ImGui::SetCursorPos({0, top});
  ImGui::BeginChild(layer_, {screen.x, bottom - top}, false, ImGuiWindowFlags_NoNav);
  draw_body(state, now_ns);
  const bool more = ImGui::GetScrollY() < ImGui::GetScrollMaxY() - 1;
  const bool long_page = more || ImGui::GetScrollY() > 0;
  ImGui::EndChild();
  if (more) draw_centred("\u2193", {(screen.x + column_) / 2, bottom}, size, colour::dim);
  draw_footer(state, now_ns);
  if (long_page && gui_.by_hand()) draw_scroll_buttons(bottom - top);
  ImGui::End();
  ImGui::PopFont();
  ImGui::PopStyleVar();
}

/// Updates the state of the mouse. A mouse that has not moved since the page appeared highlights nothing.
/// Clicks count only once the button was up while input is accepted (`counts`).
void PageView::look_at_mouse(bool counts) {
  const ImVec2 at = ImGui::GetMousePos();
  if (!begun_) {
    mouse_x_ = at.x;
    mouse_y_ = at.y;
  }
  pointed_ = pointed_ || gui_.by_hand() || at.x != mouse_x_ || at.y != mouse_y_;
  if (!counts) armed_ = false;
  if (counts && !ImGui::IsMouseDown(0) && !ImGui::IsMouseReleased(0)) armed_ = true;
}

bool PageView::hovered() const { return pointed_ && ImGui::IsItemHovered(); }

void PageView::draw_body(PageState& state, std::int64_t now_ns) {
  const float size = gui_.size_px(), room = ImGui::GetContentRegionAvail().y;
  const float left = (ImGui::GetWindowWidth() - column_) / 2;
  ImGui::SetCursorPos({left, std::max(0.0F, 0.42F * (room - height_))});
  if (!begun_) ImGui::SetScrollY(0);  // resets the scroll position of the previous page
  begun_ = true;
  if (scroll_lines_ != 0) ImGui::SetScrollY(ImGui::GetScrollY() + scroll_lines_ * 3 * size);
  scroll_lines_ = 0;
  const float begun = ImGui::GetCursorPosY();
  ImGui::BeginGroup();
  ImGui::PushTextWrapPos(left + column_);
  draw_text();
  draw_questions(state, now_ns);
  ImGui::PopTextWrapPos();
  ImGui::EndGroup();
  height_ = ImGui::GetCursorPosY() - begun;
}

void PageView::draw_text() {
  const float size = gui_.size_px();
  if (!text_.title.empty()) {
    ImGui::PushFont(gui_.title());
    draw_wrapped(text_.title, colour::text);
    ImGui::PopFont();
    ImGui::Dummy({1, 0.6F * size});
  }
  if (text_.text.empty()) return;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2{0, 0.3F * size});
  draw_wrapped(text_.text, colour::text);
  ImGui::PopStyleVar();
  ImGui::Dummy({1, 0.8F * size});
}

void PageView::draw_questions(PageState& state, std::int64_t now_ns) {
  for (std::size_t i = 0; i < state.size();) {
    const std::size_t end = end_of_table(state, i);
    if (end - i > 1) {
      draw_matrix(state, i, end, now_ns);
    } else {
      draw_question(state, i, now_ns);
    }
    ImGui::Dummy({1, 0.9F * gui_.size_px()});
    i = end;
  }
  if (state.focus() == state.size()) seen_focus_ = state.focus();
}

/// Scrolls to question i when it gets the focus, and marks it if the page has several questions.
void PageView::follow_focus(const PageState& state, std::size_t i, float top) {
  if (state.focus() != i) return;
  const float size = gui_.size_px();
  const float origin = ImGui::GetWindowPos().y - ImGui::GetScrollY();
  if (seen_focus_ != i) ImGui::SetScrollFromPosY(top - ImGui::GetWindowPos().y, 0.35F);
  seen_focus_ = i;
  if (state.size() < 2) return;
  const float x = (ImGui::GetWindowWidth() - column_) / 2 - 0.7F * size;
  const float bottom = origin + ImGui::GetCursorPosY();
  ImGui::GetWindowDrawList()->AddRectFilled({x, top}, {x + 0.18F * size, bottom}, colour::chosen);
}

void PageView::draw_footer(PageState& state, std::int64_t now_ns) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float size = gui_.size_px(), width = 9 * size, height = 2 * size;
  const ImVec2 from{(screen.x - width) / 2, screen.y - 3.7F * size}, to{from.x + width, from.y + height};
  if (state.timed()) {  // no buttons; the menu button of a headset still opens the stop dialog
    if (!gui_.by_hand()) draw_corner(gui_, text_.corner);
    return;
  }
  ImGui::SetCursorPos(from);
  const bool clicked = ImGui::InvisibleButton("on", {width, height});
  if (clicked && armed_) state.click_confirm(now_ns);
  const bool open = state.can_confirm(now_ns);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, to, !open ? colour::panel : (hovered() ? colour::hovered : colour::button),
                     0.3F * size);
  if (open && ImGui::IsItemHovered()) gui_.point_at(ImGui::GetID("on"));
  if (open && (state.focus() == state.size() || state.size() == 1))
    list.AddRect(from, to, colour::text, 0.3F * size, 0, std::max(2.0F, 0.07F * size));
  const std::string& usual = state.size() == 0 ? words_.go_on : words_.confirm;
  const std::string& label = text_.button.empty() ? usual : text_.button;
  draw_centred(label, {screen.x / 2, from.y + (height - size) / 2}, width,
               open ? colour::text : colour::faint);

  const int missing = static_cast<int>(state.missing());
  const int wait = static_cast<int>(state.wait_s(now_ns) + 0.999);
  std::string why;
  if (missing > 0)
    why = missing == 1 ? words_.one_open : fmt::format(fmt::runtime(words_.many_open), missing);
  if (missing == 0 && wait > 0) why = fmt::format(fmt::runtime(words_.wait), wait);
  draw_centred(why, {screen.x / 2, from.y - 1.3F * size}, column_, colour::dim);
  std::string how;
  if (state.focus() < state.size() && !gui_.by_hand()) {
    const Question& question = state.question(state.focus());
    const AnswerKindTraits& traits = traits_of(question.kind);
    if (traits.listed) how = one_digit_does(question) ? words_.digits : words_.arrows;
    if (traits.line) how = words_.line;
    if (const auto keys = keys_of(question); !keys.first.empty())
      how = fmt::format(fmt::runtime(words_.letters), keys.first, keys.second);
    if (!traits.scored) how = words_.tab;
  }
  draw_centred(how, {screen.x / 2, to.y + 0.35F * size}, column_, colour::faint);
  draw_corner(gui_, text_.corner);
}

/// Draws two buttons, to the right of the button to go on, that scroll most of a page up or down.
void PageView::draw_scroll_buttons(float room) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float size = gui_.size_px(), side = 2 * size, gap = 0.4F * size;
  const float lines = 0.8F * room / (3 * size);
  for (const bool down : {false, true}) {
    const float from_right = (down ? 1.0F : 2.0F) * (side + gap);
    ImGui::SetCursorScreenPos({screen.x - from_right, screen.y - 3.7F * size});
    const Target button{"scroll", 0, down ? 1 : 0, side, side};
    if (target(button, down ? "\u2193" : "\u2191")) scroll(down ? lines : -lines);
  }
}

}  // namespace study
