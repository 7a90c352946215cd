// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <string>

#include "apps/common/fluid_picture.hpp"
#include "apps/view/options.hpp"
#include "libsim/render/gl_context.hpp"
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
};

struct Figures {
  int frame = 0;
  double frame_ms = 0;
  std::int64_t particles = 0;
  stats::FpsMoments fps;
  stats::PtpeModel model;
  const char* model_origin = "";
};

void draw_panel(Controls& controls, const Figures& f) {
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
  ImGui::Checkbox("pause (space)", &controls.paused);
  ImGui::SameLine();
  if (ImGui::Button("step (s)")) controls.step_once = true;
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) controls.paused = !controls.paused;
  if (ImGui::IsKeyPressed(GLFW_KEY_S, false)) controls.step_once = true;
  ImGui::End();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
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
  Figures figures;
  figures.particles = prepared.fluid->particle_count();
  figures.model = prepared.ptpe ? prepared.ptpe->model : stats::PtpeModel{};
  figures.model_origin = prepared.ptpe ? "fitted" : "the paper's PTPE@4.0";
  double last_s = glfwGetTime();
  while (!glfwWindowShouldClose(window.get())) {
    glfwPollEvents();
    if (!controls.paused || controls.step_once) {
      prepared.fluid->step_frame();
      ++figures.frame;
      controls.step_once = false;
    }
    int width = 0, height = 0;
    glfwGetFramebufferSize(window.get(), &width, &height);
    if (width < 1 || height < 1) {  // minimised
      glfwWaitEvents();
      last_s = glfwGetTime();
      continue;
    }
    picture.draw(*prepared.fluid, sim::make_view(prepared.camera, width, height), 0);
    draw_panel(controls, figures);
    glfwSwapBuffers(window.get());
    const double now_s = glfwGetTime();
    figures.frame_ms = 1e3 * (now_s - last_s);
    if (now_s > last_s) fps.push(now_s - last_s);
    figures.fps = fps.moments();
    last_s = now_s;
  }
}

}  // namespace apps
