/// The part of class PageView that draws the questions of a page.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "libstudy/console/console_text.hpp"
#include "libstudy/pages/gui/page_view.hpp"

namespace study {

using study::AnswerKind;
using study::Question;

namespace {

/// Farthest movement of the gaze along the line of a Vas (visual analogue scale), as a fraction of the line's
/// length, that does not restart the dwell that sets the mark.
constexpr float dwell_reach = 0.04F;

}  // namespace

void PageView::draw_question(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const float size = gui_.size_px(), top = ImGui::GetCursorScreenPos().y;
  if (question.kind == AnswerKind::Reaction) return draw_cue(question);
  draw_wrapped(question.text, colour::text);
  if (!question.required) draw_wrapped("(" + words_.optional + ")", colour::faint);
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
    case AnswerKind::Vas:
      draw_line(state, i, now_ns);
      break;
    case AnswerKind::YesNo:
      draw_yes_no(state, i, now_ns);
      break;
    case AnswerKind::Reaction:
      break;
  }
  follow_focus(state, i, top);
}

bool PageView::target(const Target& what, const std::string& label) {
  const float size = gui_.size_px(), round = 0.25F * size;
  const ImVec2 from = ImGui::GetCursorScreenPos(), to{from.x + what.width, from.y + what.height};
  ImGui::PushID(static_cast<int>(what.row));
  ImGui::PushID(what.column);
  const bool clicked = ImGui::InvisibleButton(what.kind, {what.width, what.height});
  const bool reached = ImGui::GetMousePos().y > pinned_until_;
  if (reached && ImGui::IsItemHovered()) gui_.point_at(ImGui::GetID(what.kind));
  ImGui::PopID();
  ImGui::PopID();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, to, what.chosen ? colour::chosen : (hovered() ? colour::hovered : colour::button),
                     round);
  if (what.marked) list.AddRect(from, to, colour::text, round, 0, std::max(2.0F, 0.09F * size));
  const float wrap = what.left_aligned ? what.width - 1.2F * size : 0;
  const ImVec2 extent = ImGui::CalcTextSize(label.c_str(), nullptr, false, wrap);
  const ImVec2 at{what.left_aligned ? from.x + 0.6F * size : from.x + (what.width - extent.x) / 2,
                  from.y + (what.height - extent.y) / 2};
  list.AddText(nullptr, 0, at, colour::text, label.c_str(), nullptr, wrap);
  return clicked && armed_ && reached;
}

bool PageView::score_button(const PageState& state, std::size_t i, int score, const std::string& label,
                            float width, float height, bool left_aligned) {
  const PageItem& item = state.item(i);
  const bool marked = item.cursor == score && state.focus() == i;
  return target({"score", i, score, width, height, item.chosen == score, marked, left_aligned}, label);
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

/// Draws the anchors (words at scores) at the cursor. Each anchor is as wide as the distance to the nearest
/// other anchor allows.
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

/// Draws a Vas (visual analogue scale): a line with words below its ends, and a mark once the participant has
/// set it.
void PageView::draw_line(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const auto range = static_cast<float>(question.scale_max - question.scale_min);
  const float size = gui_.size_px(), edge = 0.6F * size, length = column_ - 2 * edge, height = 2 * size;
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  const float left = begun.x + edge, right = left + length, y = begun.y + height / 2;
  const float at = std::clamp((ImGui::GetMousePos().x - left) / length, 0.0F, 1.0F);
  ImGui::PushID(static_cast<int>(i));
  ImGui::InvisibleButton("line", {column_, height});
  if (ImGui::IsItemHovered()) {
    // The target changes, and so the dwell restarts, when the pointer moves along the line by more than
    // dwell_reach. So only a gaze that rests sets the mark.
    if (std::abs(at - looked_at_) > dwell_reach) looked_at_ = at;
    gui_.point_at(ImGui::GetID(std::to_string(looked_at_).c_str()));
  }
  if (ImGui::IsItemActive() && armed_)
    state.click(i, question.scale_min + static_cast<int>(std::lround(at * range)), now_ns);
  ImGui::PopID();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddLine({left, y}, {right, y}, state.focus() == i ? colour::text : colour::dim, 0.09F * size);
  if (const auto score = state.item(i).chosen) {
    const float x = left + static_cast<float>(*score - question.scale_min) / range * length;
    list.AddRectFilled({x - 0.15F * size, y - 0.65F * size}, {x + 0.15F * size, y + 0.65F * size},
                       colour::chosen);
    list.AddRect({x - 0.15F * size, y - 0.65F * size}, {x + 0.15F * size, y + 0.65F * size}, colour::text);
  }
  const float below = begun.y + height + 0.1F * size, wrap = 0.46F * column_;
  float bottom = below;
  for (const auto& [score, words] : question.anchors) {
    const ImVec2 extent = ImGui::CalcTextSize(words.c_str(), nullptr, false, wrap);
    const float x = score == question.scale_min ? begun.x : begun.x + column_ - extent.x;
    list.AddText(nullptr, 0, {x, below}, colour::dim, words.c_str(), nullptr, wrap);
    bottom = std::max(bottom, below + extent.y);
  }
  ImGui::SetCursorScreenPos({begun.x, bottom});
  ImGui::Dummy({1, 1});
}

/// Draws the text of a Reaction, a question that a press of any key answers, large and centred, and below it
/// the words that ask for the press.
void PageView::draw_cue(const Question& question) {
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  const float middle = begun.x + column_ / 2;
  ImGui::PushFont(gui_.title());
  const float below = draw_centred(question.text, {middle, begun.y}, column_, colour::text);
  ImGui::PopFont();
  const std::string& how = gui_.by_hand() ? words_.react_by_hand : words_.react;
  const float bottom = draw_centred(how, {middle, below + 0.6F * gui_.size_px()}, column_, colour::dim);
  ImGui::SetCursorScreenPos({begun.x, bottom});
  ImGui::Dummy({1, 1});
}

/// Draws two buttons side by side, or a list if their words are long.
void PageView::draw_yes_no(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Question& question = state.question(i);
  const float size = gui_.size_px(), width = 8 * size, gap = 0.4F * size;
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  for (const auto& [score, words] : question.anchors)
    if (ImGui::CalcTextSize(words.c_str()).x > width - 1.2F * size) return draw_list(state, i, now_ns);
  float x = begun.x + column_ / 2 - width - gap / 2;
  for (const auto& [score, words] : question.anchors) {
    ImGui::SetCursorScreenPos({x, begun.y});
    if (score_button(state, i, score, words, width, 2.1F * size, false)) state.click(i, score, now_ns);
    x += width + gap;
  }
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
  if (ImGui::IsItemHovered()) gui_.point_at(ImGui::GetID("number"));
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
               fmt::format(fmt::runtime(words_.range), question.scale_min, question.scale_max).c_str());
  if (focused) draw_pad(state, i, now_ns);
}

/// Draws the on-screen keyboard below a field if the participant has no keyboard.
void PageView::draw_pad(PageState& state, std::size_t i, std::int64_t now_ns) {
  const Pad* pad = pad_of(state);
  if (!pad) return;
  const float size = gui_.size_px(), gap = 0.2F * size, cell = column_ / 11;
  const ImVec2 begun = ImGui::GetCursorScreenPos();
  const auto& rows = pad->rows();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      const std::string& key = rows[row][column];
      ImGui::SetCursorScreenPos({begun.x + static_cast<float>(column) * cell,
                                 begun.y + 0.4F * size + static_cast<float>(row) * 2.1F * size});
      const Target button{"key",
                          i,
                          static_cast<int>(20 * row + column),
                          cell - gap,
                          2.1F * size - gap,
                          false,
                          pad->marked(row, column)};
      if (!target(button, key)) continue;
      pad->type(key, state, now_ns);
      return;  // the key may have moved the focus
    }
  }
}

/// Draws an edit field if the question has the focus and the participant a keyboard; else the typed words in
/// a box.
void PageView::draw_words(PageState& state, std::size_t i, std::int64_t now_ns) {
  const float size = gui_.size_px();
  const ImVec2 box{column_, 4.5F * size};
  ImGui::PushID(static_cast<int>(i));
  if (state.focus() == i && !gui_.by_hand()) {
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
    if (ImGui::IsItemHovered()) gui_.point_at(ImGui::GetID("words"));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(from, {from.x + box.x, from.y + box.y}, colour::panel);
    list.AddText(nullptr, 0, {from.x + 0.5F * size, from.y + 0.4F * size}, colour::text,
                 state.item(i).typed.c_str(), nullptr, box.x - size);
  }
  ImGui::PopID();
  if (state.focus() == i) draw_pad(state, i, now_ns);
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

/// Draws the anchors of a table again at the window's top once they have scrolled out of the window.
void PageView::pin_anchors(const Question& question, float left, float cell) {
  const ImVec2 cursor = ImGui::GetCursorScreenPos(), edge = ImGui::GetWindowPos();
  ImGui::GetWindowDrawList()->AddRectFilled(edge, {edge.x + ImGui::GetWindowWidth(), pinned_until_},
                                            colour::background);
  ImGui::SetCursorScreenPos({cursor.x, edge.y});
  draw_anchors(question, left, cell);
  ImGui::SetCursorScreenPos(cursor);
}

}  // namespace study
