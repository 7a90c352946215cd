#pragma once
/// A page for the experimenter, before the first participant: each scene as the display will frame it.

#include <filesystem>
#include <vector>

#include "apps/study/session_framing.hpp"

namespace apps {

/// Writes index.html and a picture of each scene into a folder, made where it is missing: the fluid at the
/// scene's first checkpoint, coarse, with what must stay visible outlined and the fovea as a circle in the
/// middle. paint_temperature: over the water, which then has some. base::Error: no OpenGL 4.5, a folder that
/// cannot be written.
void write_preview(const std::filesystem::path& folder, const std::vector<FramedScene>& scenes,
                   bool paint_temperature);

}  // namespace apps
