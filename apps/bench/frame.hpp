#pragma once
/// Options and run of vip-bench frame.

#include <string>

#include "libsim/simulation.hpp"
#include "stats/base/json.hpp"
#include "stats/base/picture_size.hpp"

namespace apps {

struct FrameOptions {
  std::string scene = "data/scenes/single_dam.toml";
  std::string method = "HiRes";
  std::string n_star = "4k";
  std::string backend = "auto";
  std::string tau = "live";
  std::string rate, ptpe;
  std::string setting;  ///< setting file that replaces method, n_star and the solver's numbers, and tau if
                        ///< it fixes tau; empty: none
  std::string json;
  std::string save_state;
  int frames = 100;
  int warm_up = 5;
  int measure_every = 0;
  sim::SimulationOptions fluid;  ///< the solver's numbers; method, n_* and back end are in the strings above
  bool no_render = false;
  bool passes = false;
  bool look = false;
  bool peers = false;
  base::PictureSize size{1280, 720};
  int views = 1;
  std::string surface = "ellipsoids";  ///< how the particles are drawn: ellipsoids or spheres
};

/// Runs the frames and returns all measured values.
base::Json run_frames(const FrameOptions& options);

}  // namespace apps
