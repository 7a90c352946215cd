#pragma once
/// A page for the experimenter before the first participant: each scene as the display will frame it.

#include <filesystem>
#include <vector>

#include "libstudy/runner/session_framing.hpp"

namespace study {

/// Writes index.html and a picture of each scene to a folder, made if missing: a coarse fluid at the scene's
/// first checkpoint, with outlines of what must stay visible and the fovea as a circle in the middle.
/// paint_temperature: paints the water by temperature. base::Error: no OpenGL 4.5, or the folder cannot be
/// written.
void write_preview(const std::filesystem::path& folder, const std::vector<FramedScene>& scenes,
                   bool paint_temperature);

}  // namespace study
