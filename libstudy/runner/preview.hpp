#pragma once
/// A page for the experimenter before the first participant. It shows each scene as the display will frame
/// it.

#include <filesystem>
#include <vector>

#include "libstudy/runner/session_framing.hpp"

namespace study {

/// Writes index.html and a picture of each scene to a folder, which is made if missing. A picture shows a
/// coarse fluid at the scene's first checkpoint (or at its start if the scene has none), outlines of the
/// parts that must stay visible, and the fovea as a circle in the middle. paint_temperature: paints
/// temperatures over the water. base::Error without OpenGL 4.5, or if the folder cannot be written.
void write_preview(const std::filesystem::path& folder, const std::vector<FramedScene>& scenes,
                   bool paint_temperature);

}  // namespace study
