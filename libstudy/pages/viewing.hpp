#pragma once
/// Size and visual angle of a picture on a screen of known size at a known distance.

namespace study {

/// Height of a picture with square pixels, mm. base::Error unless the width is 10 to 20,000 mm and both pixel
/// counts are positive.
double picture_height_mm(double picture_width_mm, int width_px, int height_px);

/// The vertical field of view of the camera, degrees, with which the picture looks like a window onto the
/// scene: 2 atan(h / (2 l)). h: height of the picture; l: distance of an eye in front of its middle.
/// base::Error unless h is 10 to 20,000 mm and l is 100 to 20,000 mm.
double vertical_fov_deg(double picture_height_mm, double viewing_distance_mm);

}  // namespace study
