#pragma once
/// Visual angles of a screen of known size at a known distance.

namespace study {

/// Height of a picture with square pixels, mm. All arguments > 0; base::Error otherwise.
double picture_height_mm(double picture_width_mm, int width_px, int height_px);

/// The camera's vertical field of view for which the picture is like a window onto the scene: 2 atan(h / 2d),
/// degrees, for an eye in front of its middle. base::Error unless the height is 10 to 20,000 mm and the
/// distance 100 to 20,000 mm.
double vertical_fov_deg(double picture_height_mm, double viewing_distance_mm);

}  // namespace study
