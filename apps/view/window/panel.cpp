#include "apps/view/window/panel.hpp"

// epoxy must be included before GLFW, so that GLFW does not include the system's GL headers.
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>

#include "libsim/methods/method.hpp"
#include "libsim/methods/preset.hpp"

namespace apps {

namespace {

constexpr float item_width_px = 190, price_width_px = 400;
constexpr float schedule_width_px = 480, share_width_px = 110;

/// Draws a combo box; returns true if the user chose another entry.
bool choose(const char* label, const std::vector<std::string>& words, std::size_t& at) {
  bool changed = false;
  if (!ImGui::BeginCombo(label, words[at].c_str())) return false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (ImGui::Selectable(words[i].c_str(), i == at) && i != at) {
      at = i;
      changed = true;
    }
  }
  ImGui::EndCombo();
  return changed;
}

bool choose(const char* label, const std::vector<std::string>& words, std::string& word) {
  const auto found = std::find(words.begin(), words.end(), word);
  auto at = found == words.end() ? 0 : static_cast<std::size_t>(found - words.begin());
  if (!choose(label, words, at)) return false;
  word = words[at];
  return true;
}

void begin_frame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void end_frame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void draw_figures(const Figures& f) {
  ImGui::Text("frame %d, %lld particles", f.frame, static_cast<long long>(f.particles));
  ImGui::Text("mu %.2f  delta %.2f frames/s  (last %zu)", f.fps.mean, f.fps.sd, f.fps.frames);
  ImGui::Text("tau %.2f frames/s  beta %.3f  (%s)", f.tau, f.beta, f.model.c_str());
  const double top = f.strip.scale_ms();
  const std::string scale = fmt::format("{:.2f} ms; 0 to {:g} ms", f.frame_ms, top);
  ImGui::PlotLines("frame", f.strip.ms(), FrameStrip::length, f.strip.oldest(), scale.c_str(), 0,
                   static_cast<float>(top), {0, 56});
}

/// Draws the lines and wraps long lines, so that they do not widen the panel.
void draw_price(const std::vector<std::string>& lines) {
  ImGui::PushTextWrapPos(price_width_px);
  for (const auto& line : lines) ImGui::TextWrapped("%s", line.c_str());
  ImGui::PopTextWrapPos();
}

void draw_painting(Controls& controls, const std::string& legend) {
  auto at = static_cast<std::size_t>(controls.overlay);
  if (choose("paint", overlay_titles(), at)) controls.overlay = static_cast<OverlayKind>(at);
  if (!legend.empty()) ImGui::TextUnformatted(legend.c_str());
}

void draw_running(Controls& controls) {
  ImGui::Checkbox("gaze follows the mouse", &controls.mouse_gaze);
  ImGui::Checkbox("schedule (t)", &controls.schedule);
  ImGui::SameLine();
  ImGui::Checkbox("pause (space)", &controls.paused);
  ImGui::SameLine();
  if (ImGui::Button("step (s)")) controls.step_once = true;
  if (ImGui::Button("from frame 0 (r)")) controls.restart = true;
  ImGui::SameLine();
  if (ImGui::Button("screenshot (p)")) controls.screenshot = true;
}

}  // namespace

Panel::Panel(GLFWwindow* window, const ViewOptions& opened)
    : scenes_(scenes_to_offer(opened.scene)), sizes_(sizes_to_offer(opened.n_star)) {
  for (const auto& method : sim::all_methods()) methods_.emplace_back(method.name);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

Panel::~Panel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool Panel::has_mouse() const { return ImGui::GetIO().WantCaptureMouse; }
bool Panel::has_keys() const { return ImGui::GetIO().WantTextInput; }

/// Draws the controls that restart the fluid at frame 0. A slider takes effect when it is released.
void Panel::draw_fluid(Controls& controls) {
  ViewOptions& chosen = controls.chosen;
  std::vector<std::string> titles;
  for (const auto& scene : scenes_) titles.push_back(scene_title(scene));
  auto scene =
      static_cast<std::size_t>(std::find(scenes_.begin(), scenes_.end(), chosen.scene) - scenes_.begin());
  if (choose("scene", titles, scene)) chosen.scene = scenes_[scene];
  choose("method", methods_, chosen.method);
  choose("preset", {"tuned", "paper"}, chosen.preset);
  const auto size = std::find(sizes_.begin(), sizes_.end(), chosen.n_star);
  if (!ImGui::IsAnyItemActive()) {
    size_ = static_cast<int>(size - sizes_.begin());
    levels_ = chosen.levels;
  }
  ImGui::SliderInt("n_*", &size_, 0, static_cast<int>(sizes_.size()) - 1,
                   sizes_[static_cast<std::size_t>(size_)].c_str(), ImGuiSliderFlags_NoInput);
  if (ImGui::IsItemDeactivatedAfterEdit()) chosen.n_star = sizes_[static_cast<std::size_t>(size_)];
  const auto& method = sim::traits_of(sim::parse_method(chosen.method));
  ImGui::BeginDisabled(!method.adaptive());
  ImGui::SliderInt("N levels", &levels_, 1, sim::most_levels, "%d", ImGuiSliderFlags_NoInput);
  if (ImGui::IsItemDeactivatedAfterEdit()) chosen.levels = levels_;
  ImGui::EndDisabled();
}

/// Draws the controls that take effect at the next frame.
void Panel::draw_numbers(Controls& controls) {
  const auto& method = sim::traits_of(sim::parse_method(controls.chosen.method));
  auto alpha = static_cast<float>(controls.alpha);
  ImGui::BeginDisabled(method.target != sim::TargetSource::Saliency);
  if (ImGui::SliderFloat("alpha", &alpha, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp))
    controls.chosen.alpha = static_cast<double>(alpha);
  ImGui::EndDisabled();
  int iterations = controls.iterations;
  if (ImGui::SliderInt("iterations", &iterations, 1, 16, "%d", ImGuiSliderFlags_AlwaysClamp))
    controls.chosen.iterations = iterations;
}

/// Draws a check box and a slider for each effect of the scene. The coefficient takes effect when the slider
/// is released.
void Panel::draw_effects(Controls& controls) {
  if (controls.switches.empty()) return;
  int number = 0;
  bool changed = false;
  for (EffectSwitch& one : controls.switches) {
    const auto& traits = sim::traits_of(one.effect.kind);
    const std::string label = fmt::format("{} ({})", traits.word, ++number);
    auto coefficient = static_cast<float>(one.effect.coefficient);
    ImGui::BeginDisabled(one.most == 0);
    changed |= ImGui::Checkbox(label.c_str(), &one.on);
    ImGui::SameLine(item_width_px);
    ImGui::BeginDisabled(!one.on);
    ImGui::SliderFloat(traits.key, &coefficient, 0, static_cast<float>(one.most), "%.4g",
                       ImGuiSliderFlags_NoInput);
    if (ImGui::IsItemActive()) one.effect.coefficient = static_cast<double>(coefficient);
    changed |= ImGui::IsItemDeactivatedAfterEdit();
    ImGui::EndDisabled();
    ImGui::EndDisabled();
  }
  if (changed) {
    drop_what_cannot_run(controls.switches);
    controls.chosen.effects = turned_on(controls.switches);
  }
  ImGui::Separator();
}

void Panel::draw_schedule(const PassMeans& passes) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x - 12, 12}, ImGuiCond_Once, {1, 0});
  const auto rows = passes.rows();
  const float lines = static_cast<float>(rows.size()) + 8;
  ImGui::SetNextWindowSize(
      {schedule_width_px, std::min(lines * ImGui::GetTextLineHeightWithSpacing(), display.y - 24)});
  ImGui::Begin("schedule", nullptr, ImGuiWindowFlags_NoResize);
  ImGui::Text("%.3f ms in all passes of a frame, mean over the last second", passes.total_ms());
  ImGui::TextWrapped("While this is open, each pass waits for the device: frames take longer.");
  constexpr auto flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
  if (ImGui::BeginTable("passes", 5, flags)) {
    ImGui::TableSetupScrollFreeze(0, 1);
    for (const char* head : {"phase", "pass", "effect", "ms a frame"}) ImGui::TableSetupColumn(head);
    ImGui::TableSetupColumn("share", ImGuiTableColumnFlags_WidthFixed, share_width_px);
    ImGui::TableHeadersRow();
    for (const PassRow& row : rows) {
      for (const std::string& word : {row.phase, row.name, row.effect, fmt::format("{:10.3f}", row.ms)}) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(word.c_str());
      }
      ImGui::TableNextColumn();
      ImGui::ProgressBar(static_cast<float>(row.share), {-1, ImGui::GetTextLineHeight()},
                         fmt::format("{:.1f} %", 100 * row.share).c_str());
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

void Panel::draw(Controls& controls, const Figures& figures) {
  begin_frame();
  ImGui::SetNextWindowPos({12, 12}, ImGuiCond_Once);
  ImGui::Begin("vip-view", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(item_width_px);
  draw_figures(figures);
  ImGui::Separator();
  draw_fluid(controls);
  draw_numbers(controls);
  ImGui::Separator();
  draw_effects(controls);
  if (!figures.price.empty()) {
    draw_price(figures.price);
    ImGui::Separator();
  }
  draw_painting(controls, figures.legend);
  draw_running(controls);
  if (!figures.said.empty()) ImGui::TextUnformatted(figures.said.c_str());
  ImGui::PopItemWidth();
  ImGui::End();
  if (controls.schedule) draw_schedule(figures.passes);
  end_frame();
}

void Panel::draw_progress(const std::string& text, float done) {
  begin_frame();
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::Begin("progress", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoInputs);
  ImGui::TextUnformatted(text.c_str());
  ImGui::ProgressBar(done, {360, 0});
  ImGui::End();
  end_frame();
}

}  // namespace apps
