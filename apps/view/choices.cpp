#include "apps/view/choices.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libsim/methods/method.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

constexpr const char* paper_scenes[] = {"data/scenes/single_dam.toml", "data/scenes/jet_impact.toml",
                                        "data/scenes/faucet.toml"};

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return a == b || std::filesystem::equivalent(base::find_input(a), base::find_input(b), ignored);
}

}  // namespace

Change change_between(const ViewOptions& before, const ViewOptions& after) {
  const bool other_fluid = before.scene != after.scene || before.method != after.method ||
                           before.preset != after.preset || before.n_star != after.n_star ||
                           before.levels != after.levels;
  if (other_fluid) return Change::Fluid;
  const bool other_numbers =
      before.alpha != after.alpha || before.iterations != after.iterations || before.effects != after.effects;
  return other_numbers ? Change::Numbers : Change::Nothing;
}

std::vector<std::string> scenes_to_offer(const std::string& opened) {
  std::vector<std::string> out{opened};
  for (const std::string scene : paper_scenes) {
    const bool here = std::filesystem::exists(scene) || std::filesystem::exists(base::resource(scene));
    if (here && !same_file(opened, scene)) out.push_back(scene);
  }
  return out;
}

std::string scene_title(const std::string& path) { return std::filesystem::path(path).stem().string(); }

std::vector<std::string> sizes_to_offer(const std::string& n_star) {
  std::vector<std::string> out;
  const std::int64_t chosen = sim::parse_n_star(n_star);
  const auto offer = [&](const std::string& word) {
    if (sim::parse_n_star(word) == chosen) out.push_back(n_star);
    if (sim::parse_n_star(word) != chosen) out.push_back(word);
  };
  for (int k = 1; k <= 128; k *= 2) offer(std::to_string(k) + "k");
  if (std::find(out.begin(), out.end(), n_star) == out.end()) out.push_back(n_star);
  std::sort(out.begin(), out.end(),
            [](const auto& a, const auto& b) { return sim::parse_n_star(a) < sim::parse_n_star(b); });
  return out;
}

void FrameStrip::push(double ms) {
  if (!(ms >= 0) || !std::isfinite(ms)) return;
  ms_[next_] = static_cast<float>(ms);
  next_ = (next_ + 1) % length;
}

double FrameStrip::scale_ms() const {
  const double longest = static_cast<double>(*std::max_element(ms_, ms_ + length));
  double top = 1;
  for (int step = 0; top < longest; ++step) top *= step % 3 == 1 ? 2.5 : 2;
  return top;
}

std::string screenshot_name(const ViewOptions& options, int frame) {
  return fmt::format("vip-view_{}_{}_{:04}.png", scene_title(options.scene), options.method, frame);
}

}  // namespace apps
