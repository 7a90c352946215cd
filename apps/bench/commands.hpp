#pragma once

namespace CLI {
class App;
}

namespace apps {

/// vip-bench accuracy: error and milliseconds of each setting, and what a knob buys.
void add_accuracy_command(CLI::App& app);

/// vip-bench effects: what each of a scene's effects adds to a frame.
void add_effects_command(CLI::App& app);

/// vip-bench frame: milliseconds a frame of one scene and method, with the accuracy that they buy.
void add_frame_command(CLI::App& app);

/// vip-bench growth: how the milliseconds of a substep grow with the particles.
void add_growth_command(CLI::App& app);

/// vip-bench headset: milliseconds by stage of frames of live fluid in a headset.
void add_headset_command(CLI::App& app);

/// vip-bench stability: how far the hard cases are from failing.
void add_stability_command(CLI::App& app);

/// vip-bench table1: pictures of the five methods against HiRes.
void add_table1_command(CLI::App& app);

/// vip-bench table2: particles, milliseconds by part and speed-up of the five methods.
void add_table2_command(CLI::App& app);

}  // namespace apps
