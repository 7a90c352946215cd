// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <array>
#include <cstdio>
#include <string>

#include "apps/common/fluid_picture.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libsim/render/png.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/base/error.hpp"
#include "stats/fps_window.hpp"

namespace apps {

namespace {

/// A GLFW window with a current OpenGL 4.5 context.
class Window {
 public:
  Window(int width, int height, const std::string& title) {
    if (!glfwInit()) fail("no display");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window_) {
      glfwTerminate();
      fail("no window with OpenGL 4.5");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
  }
  ~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  GLFWwindow* get() const { return window_; }

 private:
  [[noreturn]] static void fail(const std::string& problem) {
    const char* told = nullptr;
    glfwGetError(&told);
    throw base::Error("window", problem + (told ? std::string(": ") + told : std::string()),
                      "use --headless --png FOLDER on a machine without a display");
  }
  GLFWwindow* window_ = nullptr;
};

/// Dear ImGui on a window.
class Panel {
 public:
  explicit Panel(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }
  ~Panel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;
};

struct Controls {
  bool paused = false;
  bool step_once = false;
  bool mouse_gaze = true;  ///< else the scene's gaze keys
  bool screenshot = false;
  OverlayKind overlay = OverlayKind::None;
};

/// The last frames' times, for the strip.
struct Strip {
  std::array<float, 120> ms{};
  int next = 0;
  void push(double value) {
    ms[static_cast<std::size_t>(next)] = static_cast<float>(value);
    next = (next + 1) % static_cast<int>(ms.size());
  }
};

struct Figures {
  int frame = 0;
  double frame_ms = 0;
  std::int64_t particles = 0;
  stats::FpsMoments fps;
  stats::PtpeModel model;
  const char* model_origin = "";
};

void draw_choices(Controls& controls, const std::string& legend) {
  const auto& names = overlay_names();
  const auto current = static_cast<std::size_t>(controls.overlay);
  if (ImGui::BeginCombo("paint", names[current].c_str())) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (ImGui::Selectable(names[i].c_str(), i == current)) controls.overlay = static_cast<OverlayKind>(i);
    }
    ImGui::EndCombo();
  }
  if (!legend.empty()) ImGui::TextUnformatted(legend.c_str());
  ImGui::Checkbox("gaze follows the mouse", &controls.mouse_gaze);
  if (ImGui::Button("screenshot (p)")) controls.screenshot = true;
  if (ImGui::IsKeyPressed(GLFW_KEY_P, false)) controls.screenshot = true;
}

void draw_panel(Controls& controls, const Figures& f, const Strip& strip, const std::string& legend) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  ImGui::SetNextWindowPos({12, 12}, ImGuiCond_Once);
  ImGui::Begin("vip-view", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::Text("frame %d, %lld particles", f.frame, static_cast<long long>(f.particles));
  ImGui::Text("%.2f ms a frame", f.frame_ms);
  ImGui::Text("mu %.2f  delta %.2f frames/s (last %zu)", f.fps.mean, f.fps.sd, f.fps.frames);
  const double tau = stats::ptpe_tolerance(f.model, f.fps.mean, f.fps.sd);
  ImGui::Text("tau %.2f  beta %.3f  (%s)", tau, stats::activation_floor(f.model, tau), f.model_origin);
  ImGui::PlotLines("ms", strip.ms.data(), static_cast<int>(strip.ms.size()), strip.next, nullptr, 0, 50,
                   {240, 48});
  draw_choices(controls, legend);
  ImGui::Checkbox("pause (space)", &controls.paused);
  ImGui::SameLine();
  if (ImGui::Button("step (s)")) controls.step_once = true;
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) controls.paused = !controls.paused;
  if (ImGui::IsKeyPressed(GLFW_KEY_S, false)) controls.step_once = true;
  ImGui::End();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

/// Where the mouse points, or nowhere when it is over the panel or outside.
sim::Gaze mouse_gaze(GLFWwindow* window, const sim::View& view) {
  sim::Gaze gaze;
  double x = 0, y = 0;
  glfwGetCursorPos(window, &x, &y);
  int width = 0, height = 0;
  glfwGetWindowSize(window, &width, &height);
  const bool outside = x < 0 || y < 0 || x >= width || y >= height;
  if (outside || ImGui::GetIO().WantCaptureMouse) return gaze;
  const double scale = static_cast<double>(view.viewport.width) / width;
  return gaze_through(view, scale * x, scale * (height - y));
}

void save_screenshot(int width, int height, int frame) {
  const std::string path = "vip-view_" + std::to_string(frame) + ".png";
  sim::write_png(path, sim::read_framebuffer(0, width, height));
  std::printf("%s\n", path.c_str());
}

}  // namespace

void run_window(const ViewOptions& options) {
  const Window window(options.width_px, options.height_px, "vip-view");
  sim::require_gl45();
  const PreparedFluid prepared = prepare_fluid(options);
  const Panel panel(window.get());
  FluidPicture picture(prepared.scene);
  stats::FpsWindow fps(30);
  Controls controls;
  controls.overlay = parse_overlay(options.overlay);
  OverlayPainter painter(prepared.finest_spacing_m);
  Strip strip;
  Figures figures;
  figures.particles = prepared.fluid->particle_count();
  figures.model = prepared.ptpe ? prepared.ptpe->model : stats::PtpeModel{};
  figures.model_origin = prepared.ptpe ? "fitted" : "the paper's PTPE@4.0";
  double last_s = glfwGetTime();
  while (!glfwWindowShouldClose(window.get())) {
    glfwPollEvents();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window.get(), &width, &height);
    if (width < 1 || height < 1) {  // minimised
      glfwWaitEvents();
      last_s = glfwGetTime();
      continue;
    }
    const sim::View view = sim::make_view(prepared.camera, width, height);
    if (!controls.paused || controls.step_once) {
      const auto by_keys = gaze_at(prepared.camera, sim::gaze_point(prepared.scene, figures.frame + 1));
      picture.look(*prepared.fluid, view, controls.mouse_gaze ? mouse_gaze(window.get(), view) : by_keys);
      prepared.fluid->step_frame();
      ++figures.frame;
      controls.step_once = false;
    }
    picture.draw(*prepared.fluid, view, 0);
    painter.paint(controls.overlay, *prepared.fluid, picture, 0);
    if (controls.screenshot) save_screenshot(width, height, figures.frame);
    controls.screenshot = false;
    draw_panel(controls, figures, strip, painter.legend());
    glfwSwapBuffers(window.get());
    const double now_s = glfwGetTime();
    figures.frame_ms = 1e3 * (now_s - last_s);
    strip.push(figures.frame_ms);
    prepared.fluid->frame_time(figures.frame_ms);
    figures.particles = prepared.fluid->particle_count();
    if (now_s > last_s) fps.push(now_s - last_s);
    figures.fps = fps.moments();
    last_s = now_s;
  }
}

}  // namespace apps
