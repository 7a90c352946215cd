#pragma once

namespace CLI {
class App;
}

namespace apps {

/// vip-bench accuracy: error and milliseconds of each setting, and the effect of each knob.
void add_accuracy_command(CLI::App& app);

/// vip-bench effects: the cost per frame of each of a scene's effects.
void add_effects_command(CLI::App& app);

/// vip-bench frame: milliseconds per frame of one scene and method, with the resulting accuracy.
void add_frame_command(CLI::App& app);

/// vip-bench growth: growth of a substep's milliseconds with the number of particles.
void add_growth_command(CLI::App& app);

/// vip-bench headset: milliseconds by stage of frames of live fluid in a headset.
void add_headset_command(CLI::App& app);

/// vip-bench stability: safety margin of the hard cases.
void add_stability_command(CLI::App& app);

/// vip-bench table1: pictures of the five methods against HiRes.
void add_table1_command(CLI::App& app);

/// vip-bench table2: particles, milliseconds by part and speed-up of the five methods.
void add_table2_command(CLI::App& app);

}  // namespace apps
