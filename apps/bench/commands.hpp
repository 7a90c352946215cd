#pragma once

namespace CLI {
class App;
}

namespace apps {

/// vip-bench accuracy: error and milliseconds per frame of each solver setting, and the effect of each
/// parameter of the solver.
void add_accuracy_command(CLI::App& app);

/// vip-bench effects: milliseconds per frame that each effect of a scene costs.
void add_effects_command(CLI::App& app);

/// vip-bench frame: milliseconds per frame of one scene and method, with the density error that results.
void add_frame_command(CLI::App& app);

/// vip-bench growth: how the milliseconds of a substep grow with the number of particles.
void add_growth_command(CLI::App& app);

/// vip-bench headset: milliseconds of each stage of a frame, for live fluid in a headset.
void add_headset_command(CLI::App& app);

/// vip-bench stability: how far the frame step, the iterations and the own quantity (such as a speed) of each
/// hard case, a scene that strains the solver, can change before the case fails.
void add_stability_command(CLI::App& app);

/// vip-bench surface: errors of the drawn surface of water of known shape, change of the picture where levels
/// change, and milliseconds of the renderer.
void add_surface_command(CLI::App& app);

/// vip-bench table1: the paper's Table 1, image quality of the methods' pictures with those of HiRes as
/// reference.
void add_table1_command(CLI::App& app);

/// vip-bench table2: the paper's Table 2: number of particles, milliseconds of each part of a frame and
/// speed-up of the five methods.
void add_table2_command(CLI::App& app);

}  // namespace apps
