#include "apps/study/window/page_view.hpp"

#include <imgui.h>

#include <algorithm>
#include <cstdio>

namespace apps {

namespace {

using study::AnswerKind;
using study::Question;

constexpr ImGuiWindowFlags plain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
                                   ImGuiWindowFlags_NoNav;
/// Questions in a row that look alike become a table from this many on.
constexpr std::size_t fewest_rows = 3;

std::string with(const std::string& pattern, int a, int b = 0) {
  char out[200];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  std::snprintf(out, sizeof out, pattern.c_str(), a, b);
#pragma GCC diagnostic pop
  return out;
}

bool looks_like(const Question& a, const Question& b) {
  return a.kind == AnswerKind::Scale && b.kind == AnswerKind::Scale && a.scale_min == b.scale_min &&
         a.scale_max == b.scale_max && a.anchors == b.anchors;
}

/// Where the questions that look like `first` end.
std::size_t end_of_table(const PageState& state, std::size_t first) {
  std::size_t end = first + 1;
  while (end < state.size() && looks_like(state.question(first), state.question(end))) ++end;
  return end - first >= fewest_rows ? end : first + 1;
}

void wrapped(const std::string& words, unsigned colour) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(words.c_str(), words.c_str() + words.size());
  ImGui::PopStyleColor();
}

}  // namespace

bool PageView::typing(const PageState& state) const {
  return state.focus() < state.size() && state.question(state.focus()).kind == AnswerKind::Text;
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
  ImGui::EndChild();
  if (more) draw_centred("\u2193", {(screen.x + column_) / 2, bottom}, size, colour::dim);
  draw_footer(state, now_ns);
  ImGui::End();
  ImGui::PopFont();
  ImGui::PopStyleVar();
}

/// A mouse that happens to lie somewhere lights nothing, and its button counts once it was up.
void PageView::look_at_mouse(bool counts) {
  const ImVec2 at = ImGui::GetMousePos();
  if (!begun_) {
    mouse_x_ = at.x;
    mouse_y_ = at.y;
  }
  pointed_ = pointed_ || at.x != mouse_x_ || at.y != mouse_y_;
  if (!counts) armed_ = false;
  if (counts && !ImGui::IsMouseDown(0) && !ImGui::IsMouseReleased(0)) armed_ = true;
}

bool PageView::hovered() const { return pointed_ && ImGui::IsItemHovered(); }

void PageView::draw_body(PageState& state, std::int64_t now_ns) {
  const float size = gui_.size_px(), room = ImGui::GetContentRegionAvail().y;
  const float left = (ImGui::GetWindowWidth() - column_) / 2;
  ImGui::SetCursorPos({left, std::max(0.0F, 0.42F * (room - height_))});
  if (!begun_) ImGui::SetScrollY(0);  // where the page before was scrolled to
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
    wrapped(text_.title, colour::text);
    ImGui::PopFont();
    ImGui::Dummy({1, 0.6F * size});
  }
  if (text_.text.empty()) return;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2{0, 0.3F * size});
  wrapped(text_.text, colour::text);
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

/// Scrolls to a question when the focus comes to it, and marks it where there are several.
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

void PageView::draw_question(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const float size = gui_.size_px(), top = ImGui::GetCursorScreenPos().y;
  wrapped(question.text, colour::text);
  if (!question.required) wrapped("(" + words_.optional + ")", colour::faint);
  ImGui::Dummy({1, 0.35F * size});
  switch (question.kind) {
    case AnswerKind::Scale:
      draw_scale(state, i, now_ns);
      break;
    case AnswerKind::Choice:
      draw_list(state, i, now_ns);
      break;
    case AnswerKind::Number:
      draw_number(state, i, now_ns);
      break;
    case AnswerKind::Text:
      draw_words(state, i, now_ns);
      break;
  }
  follow_focus(state, i, top);
}

bool PageView::score_button(const PageState& state, std::size_t i, int score, const std::string& label,
                            float width, float height, bool left_aligned) {
  const float size = gui_.size_px(), round = 0.25F * size;
  const ImVec2 from = ImGui::GetCursorScreenPos(), to{from.x + width, from.y + height};
  ImGui::PushID(static_cast<int>(i));
  ImGui::PushID(score);
  const bool clicked = ImGui::InvisibleButton("score", {width, height});
  ImGui::PopID();
  ImGui::PopID();
  const PageItem& item = state.item(i);
  const bool chosen = item.chosen == score;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, to, chosen ? colour::chosen : (hovered() ? colour::hovered : colour::button),
                     round);
  if (item.cursor == score && state.focus() == i)
    list.AddRect(from, to, colour::text, round, 0, std::max(2.0F, 0.09F * size));
  const float wrap = left_aligned ? width - 1.2F * size : 0;
  const ImVec2 extent = ImGui::CalcTextSize(label.c_str(), nullptr, false, wrap);
  const ImVec2 at{left_aligned ? from.x + 0.6F * size : from.x + (width - extent.x) / 2,
                  from.y + (height - extent.y) / 2};
  list.AddText(nullptr, 0, at, colour::text, label.c_str(), nullptr, wrap);
  return clicked && armed_ && ImGui::GetMousePos().y > pinned_until_;
}

void PageView::draw_scale(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const auto scores = scores_of(question);
  const float size = gui_.size_px(), count = static_cast<float>(scores.size());
  const bool all_words = question.anchors.size() == scores.size();
  const float cell = std::min(column_ / count, (all_words ? 8.0F : 5.0F) * size);
  const float gap = std::min(0.4F * size, 0.12F * cell);
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  const float left = begun.x + (column_ - cell * count) / 2;
  for (std::size_t k = 0; k < scores.size(); ++k) {
    ImGui::SetCursorScreenPos({left + static_cast<float>(k) * cell + gap / 2, begun.y});
    if (score_button(state, i, scores[k], std::to_string(scores[k]), cell - gap, 2.1F * size, false))
      state.click(i, scores[k], now_ns);
  }
  ImGui::SetCursorScreenPos({begun.x, begun.y + 2.4F * size});
  draw_anchors(question, left, cell);
}

/// Words below (or above) the scores, each as wide as its neighbours allow.
void PageView::draw_anchors(const Question& question, float left, float cell) {
  const float y = ImGui::GetCursorScreenPos().y, x = ImGui::GetCursorScreenPos().x;
  float bottom = y;
  for (std::size_t k = 0; k < question.anchors.size(); ++k) {
    const auto& [score, words] = question.anchors[k];
    int nearest = question.scale_max - question.scale_min + 1;
    if (k > 0) nearest = std::min(nearest, score - question.anchors[k - 1].first);
    if (k + 1 < question.anchors.size()) nearest = std::min(nearest, question.anchors[k + 1].first - score);
    const float centre = left + (static_cast<float>(score - question.scale_min) + 0.5F) * cell;
    const float width = std::max(static_cast<float>(nearest) * cell * 0.92F, 2 * gui_.size_px());
    bottom = std::max(bottom, draw_centred(words, {centre, y}, width, colour::dim));
  }
  ImGui::SetCursorScreenPos({x, bottom});
  ImGui::Dummy({1, 1});
}

void PageView::draw_list(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const float size = gui_.size_px(), width = std::min(column_, 26 * size);
  const float x = ImGui::GetCursorScreenPos().x;
  for (const auto& [score, words] : question.anchors) {
    const std::string label = one_digit_does(question) ? std::to_string(score) + "   " + words : words;
    const float height =
        ImGui::CalcTextSize(label.c_str(), nullptr, false, width - 1.2F * size).y + 0.9F * size;
    ImGui::SetCursorScreenPos({x, ImGui::GetCursorScreenPos().y + 0.12F * size});
    if (score_button(state, i, score, label, width, height, true)) state.click(i, score, now_ns);
  }
}

void PageView::draw_number(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const float size = gui_.size_px(), width = 7 * size, height = 2.1F * size;
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  const ImVec2 from = begun, to{from.x + width, from.y + height};
  ImGui::SetCursorScreenPos(from);
  ImGui::PushID(static_cast<int>(i));
  if (ImGui::InvisibleButton("number", {width, height})) state.click_question(i, now_ns);
  ImGui::PopID();
  const bool focused = state.focus() == i, wrong = state.out_of_range(i);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, to, colour::panel, 0.25F * size);
  list.AddRect(from, to,
               wrong     ? colour::warning
               : focused ? colour::text
                         : colour::button,
               0.25F * size, 0, 2);
  const bool caret = focused && (now_ns / 500'000'000) % 2 == 0;
  const std::string& typed = state.item(i).typed;
  const float y = from.y + (height - size) / 2;
  const float w = ImGui::CalcTextSize(typed.c_str()).x;
  list.AddText({from.x + (width - w) / 2, y}, colour::text, typed.c_str());
  const float after = from.x + (width + w) / 2 + 2;
  if (caret) list.AddLine({after, y}, {after, y + size}, colour::text, 2);
  list.AddText({to.x + size, y}, wrong ? colour::warning : colour::dim,
               with(words_.range, question.scale_min, question.scale_max).c_str());
}

/// A field while it has the focus, else its words in a box.
void PageView::draw_words(PageState& state, std::size_t i, std::int64_t now_ns) {
  const float size = gui_.size_px();
  const ImVec2 box{column_, 4.5F * size};
  ImGui::PushID(static_cast<int>(i));
  if (state.focus() == i) {
    const bool begins = editing_ != i;
    if (begins) {
      edited_ = state.item(i).typed;
      edited_.resize(PageState::most_bytes + 1, '\0');
      ImGui::SetKeyboardFocusHere();
    }
    editing_ = i;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2{0.5F * size, 0.4F * size});
    ImGui::PushStyleColor(ImGuiCol_FrameBg, colour::panel);
    ImGui::InputTextMultiline("##words", edited_.data(), edited_.size(), box);
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
    if (!begins) state.write(i, edited_.c_str(), now_ns);
  } else {
    if (editing_ == i) editing_ = state.size();
    const ImVec2 from = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("words", box)) state.click_question(i, now_ns);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(from, {from.x + box.x, from.y + box.y}, colour::panel);
    list.AddText(nullptr, 0, {from.x + 0.5F * size, from.y + 0.4F * size}, colour::text,
                 state.item(i).typed.c_str(), nullptr, box.x - size);
  }
  ImGui::PopID();
}

void PageView::draw_matrix(PageState& state, std::size_t first, std::size_t end, std::int64_t now_ns) {
  const Question& model = state.question(first);
  const auto scores = scores_of(model);
  const float size = gui_.size_px(), count = static_cast<float>(scores.size());
  const float label = 0.4F * column_, cell = std::min((column_ - label) / count, 6.5F * size);
  const float x = ImGui::GetCursorScreenPos().x, left = x + column_ - cell * count, gap = 0.2F * size;
  const float head = ImGui::GetCursorScreenPos().y;
  draw_anchors(model, left, cell);
  const float edge = ImGui::GetWindowPos().y, head_height = ImGui::GetCursorScreenPos().y - head;
  if (head < edge) pinned_until_ = edge + head_height;
  for (std::size_t i = first; i < end; ++i) {
    const float top = ImGui::GetCursorScreenPos().y + 0.15F * size;
    const std::string& words = state.question(i).text;
    const float wrap = left - x - size;
    const float text_height = ImGui::CalcTextSize(words.c_str(), nullptr, false, wrap).y;
    const float height = std::max(1.5F * size, text_height);
    ImGui::GetWindowDrawList()->AddText(nullptr, 0, {x, top + (height - text_height) / 2}, colour::text,
                                        words.c_str(), nullptr, wrap);
    for (std::size_t k = 0; k < scores.size(); ++k) {
      ImGui::SetCursorScreenPos({left + static_cast<float>(k) * cell + gap / 2, top});
      if (score_button(state, i, scores[k], std::to_string(scores[k]), cell - gap, height, false))
        state.click(i, scores[k], now_ns);
    }
    ImGui::SetCursorScreenPos({x, top + height});
    ImGui::Dummy({1, 1});
    follow_focus(state, i, top);
  }
  if (head < edge && ImGui::GetCursorScreenPos().y > edge + 2 * head_height) pin_anchors(model, left, cell);
  pinned_until_ = -1;
}

/// A table whose words have left the window at the top keeps them in sight.
void PageView::pin_anchors(const Question& question, float left, float cell) {
  const ImVec2 cursor = ImGui::GetCursorScreenPos(), edge = ImGui::GetWindowPos();
  ImGui::GetWindowDrawList()->AddRectFilled(edge, {edge.x + ImGui::GetWindowWidth(), pinned_until_},
                                            colour::background);
  ImGui::SetCursorScreenPos({cursor.x, edge.y});
  draw_anchors(question, left, cell);
  ImGui::SetCursorScreenPos(cursor);
}

void PageView::draw_footer(PageState& state, std::int64_t now_ns) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float size = gui_.size_px(), width = 9 * size, height = 2 * size;
  const ImVec2 from{(screen.x - width) / 2, screen.y - 3.7F * size}, to{from.x + width, from.y + height};
  ImGui::SetCursorPos(from);
  const bool clicked = ImGui::InvisibleButton("on", {width, height});
  if (clicked && armed_) state.click_confirm(now_ns);
  const bool open = state.can_confirm(now_ns);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, to, !open ? colour::panel : (hovered() ? colour::hovered : colour::button),
                     0.3F * size);
  if (open && (state.focus() == state.size() || state.size() == 1))
    list.AddRect(from, to, colour::text, 0.3F * size, 0, std::max(2.0F, 0.07F * size));
  const std::string& usual = state.size() == 0 ? words_.go_on : words_.confirm;
  const std::string& label = text_.button.empty() ? usual : text_.button;
  draw_centred(label, {screen.x / 2, from.y + (height - size) / 2}, width,
               open ? colour::text : colour::faint);

  const int missing = static_cast<int>(state.missing());
  const int wait = static_cast<int>(state.wait_s(now_ns) + 0.999);
  std::string why;
  if (missing > 0) why = missing == 1 ? words_.one_open : with(words_.many_open, missing);
  if (missing == 0 && wait > 0) why = with(words_.wait, wait);
  draw_centred(why, {screen.x / 2, from.y - 1.3F * size}, column_, colour::dim);
  std::string how;
  if (state.focus() < state.size()) {
    const Question& question = state.question(state.focus());
    const bool listed = question.kind == AnswerKind::Scale || question.kind == AnswerKind::Choice;
    if (listed) how = one_digit_does(question) ? words_.digits : words_.arrows;
    if (question.kind == AnswerKind::Text) how = words_.tab;
  }
  draw_centred(how, {screen.x / 2, to.y + 0.35F * size}, column_, colour::faint);
  draw_corner(gui_, text_.corner);
}

}  // namespace apps
