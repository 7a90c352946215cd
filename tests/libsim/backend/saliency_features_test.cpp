/// The features of saliency (Eq. 1-8 of the paper) against closed forms.

#include <random>

#include "stats/base/error.hpp"
#include "tests/libsim/backend/saliency_helpers.hpp"

namespace sim::SIM_BACKEND {
namespace {

using namespace saliency_test;

Looks one_eye(const View& view, const GBuffer* seen, Vec3d direction = {0, 0, -1}) {
  return {{{{{0, 0, 0}, direction, true}, view, seen}}};
}

/// The parts of saliency of particles at these places. `temporal`, the same for all, is the temporal feature
/// before it is divided by the attenuation gamma_t of hidden particles: f_T gamma_t of Eq. 6.
std::vector<SaliencyParts> parts_of(const std::vector<Vec4>& points, const Looks& looks, float temporal = 0,
                                    const Readings& readings = {}) {
  SaliencyInput input;
  input.look(looks);
  const Eyes eyes = input.next_frame(1.0 / 60, 0.5);
  Array<Vec4> position;
  position.from_host(points);
  Array<float> gradient, combined(points.size());
  gradient.from_host(std::vector<float>(points.size(), temporal));
  Array<SaliencyParts> parts(points.size());
  combine_features(feature_numbers(readings), eyes, position.data(), gradient.data(), combined.data(),
                   parts.data(), static_cast<int>(points.size()));
  return parts.to_host();
}

/// For each gaze, one a frame, the degrees by which it has turned since the gaze of the frame before.
std::vector<double> turns_of(const std::vector<Gaze>& gazes, const std::vector<View>& views) {
  SaliencyInput input;
  std::vector<double> out;
  for (std::size_t k = 0; k < gazes.size(); ++k) {
    const Looks looks{{{gazes[k], views[k % views.size()], nullptr}}};
    const double before = input.turned_deg(looks);
    input.look(looks);
    EXPECT_EQ(input.turned_deg(), before);
    out.push_back(before);
    input.next_frame(0.1, 0.25);
    input.mark_gazes(0.25);
  }
  return out;
}

SIM_TEST(SaliencyGaze, TurnsWithTheEyeAndItsPlaceAndStaysInABlink) {
  const View view = view_along_z(64, 48);
  const double slope = std::tan(3 * std::acos(-1.0) / 180);
  const Gaze ahead{{0, 0, 0}, {0, 0, -1}, true}, aside{{0, 0, 0}, {slope, 0, -1}, true};
  const Gaze stepped{{slope, 0, 0}, {0, 0, -1}, true}, lost{};
  auto turned = turns_of({ahead, ahead, aside, ahead, stepped}, {view});
  EXPECT_EQ(turned[0], 180);
  EXPECT_NEAR(turned[1], 0, 1e-5);
  EXPECT_NEAR(turned[2], 3, 1e-5);
  EXPECT_NEAR(turned[4], 3, 1e-5) << "as far as an eye that turns by what a metre away is the shift";
  // A lost gaze is held for 0.25 s (frames of 0.1 s), even if the head turns.
  turned = turns_of({aside, lost, lost, aside}, {view, view_of({0, 0, 0}, {1, 0, -1}, 64, 48)});
  EXPECT_EQ(turned[1], 0);
  EXPECT_EQ(turned[2], 0);
  EXPECT_NEAR(turned[3], 0, 1e-5);
  // If it is lost for longer, the view's axis replaces it.
  turned = turns_of({aside, lost, lost, lost, lost, aside}, {view});
  EXPECT_NEAR(turned[4], 0, 1e-5);
  EXPECT_NEAR(turned[5], 3, 1e-5);
}

SIM_TEST(Acuity, IsOneAtTheGazeAtTheImagePlaneAndHalfAtTwice) {
  const View view = view_along_z(64, 48);
  const auto parts = parts_of({{0, 0, -1, 0.3f}, {0, 0, -2, 0.3f}, {0, 0, -0.2f, 0.3f}, {0, 0, 1, 0.3f}},
                              one_eye(view, nullptr));
  EXPECT_EQ(parts[0].acuity, 1);
  EXPECT_EQ(parts[1].acuity, 0.5f);
  EXPECT_EQ(parts[2].acuity, 1) << "nearer than the image plane";
  EXPECT_EQ(parts[3].acuity, 0) << "behind the viewer";
}

SIM_TEST(Acuity, DepthFactorIsTheRatioToTheImagePlane) {
  // Eq. 4 with its intersection computed in doubles, against z / z_Pi of the kernel's camera.
  const View view = view_of({3, 2, 5}, {1, 0.5, -2}, 64, 48);
  const Mat4 pose = rigid_inverse(view.view);
  SaliencyInput input;
  input.look(one_eye(view, nullptr));
  const Eye eye = input.next_frame(1.0 / 60, 0.5).eye[0];
  const Acuity acuity{AcuityFalloff::Hyperbolic, 0.13f, 1.5f};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> at(-0.9, 0.9);
  for (int k = 0; k < 200; ++k) {
    // A point at depth z off the axis, in the world.
    const double z = 0.5 + 10 * std::abs(at(random));
    const double eye_place[3] = {at(random) * z, at(random) * z, -z};
    double x[3], forward[3], way = 0, along = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      x[a] = static_cast<double>(pose[12 + a]);
      for (std::size_t c = 0; c < 3; ++c) x[a] += static_cast<double>(pose[4 * c + a]) * eye_place[c];
      forward[a] = -static_cast<double>(pose[8 + a]);
      const double u = x[a] - static_cast<double>(pose[12 + a]);
      way += u * u;
      along += u * forward[a];
    }
    way = std::sqrt(way);
    const double to_plane = 1.5 * way / along;  // where the line of view meets the plane
    const Vec3 point = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
    const float kernel = acuity.depth_factor(-eye.now(point).z);
    EXPECT_NEAR(static_cast<double>(kernel), way / to_plane, 1e-6 * way / to_plane + 1e-6);
  }
}

SIM_TEST(Acuity, FallsFromOneAndNeverRises) {
  using Kind = AcuityFalloff;
  const float fovea = Acuity::radians(7.5f);
  for (const Kind kind : {Kind::Hyperbolic, Kind::Steep, Kind::Smoothstep}) {
    const Acuity acuity{kind, fovea, 1};
    EXPECT_EQ(acuity.falloff_at(0), 1);
    EXPECT_EQ(acuity.falloff_at(fovea), 1);
    float before = 1;
    for (int degree = 1; degree <= 180; ++degree) {
      const float now = acuity.falloff_at(Acuity::radians(static_cast<float>(degree)));
      EXPECT_LE(now, before) << degree;
      EXPECT_GE(now, 0) << degree;
      before = now;
    }
    EXPECT_LT(before, 0.02f) << "the periphery must count less";
  }
  EXPECT_NEAR((Acuity{Kind::Hyperbolic, fovea, 1}.falloff_at(Acuity::radians(7.5f + 2.3f))), 0.5f, 1e-6f);
  EXPECT_EQ((Acuity{Kind::Smoothstep, fovea, 1}.falloff_at(Acuity::radians(30))), 0);
}

/// A picture of 520 x 292.5 mm seen from 600 mm, drawn by a camera of 75 degrees.
struct Desk {
  static constexpr double half_height_mm = 146.25, distance_mm = 600, degree = 0.017453292519943295;
  const double half_slope = std::tan(37.5 * degree);

  /// The point at depth 3 m that the camera draws at this place of the picture, mm from the picture's middle.
  Vec3 point(double x_mm, double y_mm) const {
    const double slope_by_mm = half_slope / half_height_mm;
    return {static_cast<float>(3 * x_mm * slope_by_mm), static_cast<float>(3 * y_mm * slope_by_mm), -3};
  }
  Eye eye_that_looks_at(double x_mm, double y_mm, double visual_scale) const {
    const Vec3 to = point(x_mm, y_mm);
    Looks looks = one_eye(view_along_z(64, 36), nullptr, {to.x, to.y, to.z});
    looks.eyes[0].visual_scale = visual_scale;
    SaliencyInput input;
    input.look(looks);
    return input.next_frame(1.0 / 60, 0.5).eye[0];
  }
  double scale() const { return half_height_mm / distance_mm / half_slope; }
};

SIM_TEST(Acuity, EccentricityIsTheAngleAtTheEyeWhateverTheCameras) {
  const Desk desk;
  // Pairs of places, mm from the middle of the picture.
  const double places[][4] = {{0, 0, 79, 0}, {-200, 100, 200, -100}, {100, 0, 179, 20}, {250, 140, 0, 0}};
  for (const auto& [gx, gy, x, y] : places) {
    const Eye eye = desk.eye_that_looks_at(gx, gy, desk.scale());
    const double d = Desk::distance_mm, along = gx * x + gy * y + d * d;
    const double expected = std::acos(
        along / (std::hypot(gx, gy, d) * std::hypot(x, y, d)));  // angle between the two places, at the eye
    EXPECT_NEAR(static_cast<double>(Acuity::eccentricity(eye, desk.point(x, y))), expected, 1e-4);
  }
}

SIM_TEST(Acuity, TheFoveasRimLiesAtItsVisualAngle) {
  const Desk desk;
  const Acuity acuity{AcuityFalloff::Hyperbolic, Acuity::radians(7.5f), 1};
  const auto e = [&](double visual_deg, double scale) {
    const Vec3 at = desk.point(0, Desk::distance_mm * std::tan(visual_deg * Desk::degree));
    return acuity.falloff_at(Acuity::eccentricity(desk.eye_that_looks_at(0, 0, scale), at));
  };
  EXPECT_EQ(e(7.4999, desk.scale()), 1);
  EXPECT_LT(e(7.6, desk.scale()), 0.97f);
  EXPECT_NEAR(e(7.5 + 2.3, desk.scale()), 0.5f, 1e-3f);
  EXPECT_LT(e(7.4999, 1), 0.2f) << "in the camera's angle it lies at 22.8 degrees";
}

SIM_TEST(Acuity, TheBandAroundTheFoveaKeepsItsWidthInTheScene) {
  const Desk desk;
  const Acuity acuity{AcuityFalloff::Hyperbolic, Acuity::radians(1), 1};
  for (const double scale : {1.0, desk.scale()}) {
    const Eye eye = desk.eye_that_looks_at(0, 0, scale);
    const double rim_m = 3 * std::tan(Desk::degree) / scale;  // radius of the fovea's rim, 3 m deep
    const Vec3 outside = {static_cast<float>(rim_m + 0.1), 0, -3};
    EXPECT_NEAR(acuity.gaze_saliency(eye, outside, 0.2f), 0.5f, 0.02f) << scale;
    EXPECT_EQ(acuity.gaze_saliency(eye, {static_cast<float>(rim_m + 0.3), 0, -3}, 0.2f), 0) << scale;
  }
}

SIM_TEST(Acuity, APictureThatFillsNoAngleIsRefused) {
  SaliencyInput input;
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    Looks looks = one_eye(view_along_z(8, 8), nullptr);
    looks.eyes[0].visual_scale = bad;
    EXPECT_THROW(input.look(looks), base::Error) << bad;
  }
}

SIM_TEST(Acuity, TellsSmallAnglesApart) {
  SaliencyInput input;
  input.look(one_eye(view_along_z(8, 8), nullptr));
  const Eye eye = input.next_frame(1.0 / 60, 0.5).eye[0];
  // 0.001 degrees: an arc cosine of a float would give 0 or 0.02.
  const double angle = 0.001 * 0.017453292519943;
  const float theta = Acuity::eccentricity(eye, {static_cast<float>(2 * std::tan(angle)), 0, -2});
  EXPECT_NEAR(static_cast<double>(theta), angle, 1e-5 * angle);
  EXPECT_NEAR(Acuity::eccentricity(eye, {0, 0, 3}), 3.14159265f, 1e-6f);
}

SIM_TEST(Manifold, IsZeroOnAPlaneAndWithoutFluid) {
  const View view = view_along_z(160, 120);
  const GBuffer flat = picture_of(view, plane(3));
  const GBuffer empty = picture_of(view, nothing());
  std::vector<Vec4> points;
  for (int k = 0; k < 60; ++k) {
    points.push_back({0.02f * static_cast<float>(k % 10), 0.02f * static_cast<float>(k / 10), -3.1f, 0.3f});
  }
  for (const auto& part : parts_of(points, one_eye(view, &flat))) EXPECT_EQ(part.manifold, 0);
  for (const auto& part : parts_of(points, one_eye(view, &empty))) EXPECT_EQ(part.manifold, 0);
  // Out of the picture, behind the eye, and without a picture.
  for (const auto& part : parts_of({{50, 0, -3, 0.3f}, {0, 0, 3, 0.3f}}, one_eye(view, &flat)))
    EXPECT_EQ(part.manifold, 0);
  EXPECT_EQ(parts_of({{0, 0, -3, 0.3f}}, one_eye(view, nullptr))[0].manifold, 0);
}

SIM_TEST(Manifold, OnABallIsFiveRadiiOverItsRadius) {
  // Round the near pole a unit normal turns by 1 / R_s for each metre, and the mean distance from the centre
  // of a square is 0.7652 of its half side.
  const View view = view_along_z(800, 600);
  for (const double ball_radius : {0.8, 1.0, 1.5}) {
    const double near = 4;
    const GBuffer g = picture_of(view, ball(near + ball_radius, ball_radius));
    for (const float h : {0.08f, 0.12f, 0.16f}) {
      const auto part =
          parts_of({{0.002f, 0.003f, static_cast<float>(-near) - h / 4, h}}, one_eye(view, &g))[0];
      const double gamma_d = near + static_cast<double>(h) / 4;
      const double expected = 0.7652 * 5 * static_cast<double>(h) / 4 / ball_radius;
      EXPECT_NEAR(static_cast<double>(part.manifold) * gamma_d, expected, 0.2 * expected)
          << ball_radius << " " << h;
    }
  }
}

SIM_TEST(Manifold, DoesNotDependOnTheResolution) {
  const auto mean_at = [](int width, int height) {
    const View view = view_along_z(width, height);
    const GBuffer g = picture_of(view, ball(5, 1));
    std::vector<Vec4> points;
    for (int k = 0; k < 400; ++k) {
      const double x = -0.6 + 0.06 * (k % 20) + 0.011, y = -0.6 + 0.06 * (k / 20) + 0.007;
      const double z = 5 - std::sqrt(1 - x * x - y * y);
      points.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(-z), 0.12f});
    }
    double sum = 0;
    for (const auto& part : parts_of(points, one_eye(view, &g))) sum += static_cast<double>(part.manifold);
    return sum / 400;
  };
  // Windows of 4, 8, 16 and 31 px.
  double before = mean_at(160, 120);
  ASSERT_GT(before, 0.005);
  for (const int scale : {2, 4, 8}) {
    const double now = mean_at(160 * scale, 120 * scale);
    EXPECT_NEAR(now, before, 0.05 * before) << scale;
    before = now;
  }
}

SIM_TEST(Occlusion, AttenuationHasItsClosedForm) {
  using Kind = ThicknessWeight;
  const Attenuation least{Kind::Min, 0.5f};
  EXPECT_EQ(least.at(0), 1);
  EXPECT_NEAR(least.at(3.2189f), 5, 1e-4f);
  EXPECT_EQ(least.at(10), 5);
  EXPECT_EQ(least.at(-1), 1) << "the thickness is at least 0";
  const Attenuation literal{Kind::Max, 0.5f};
  EXPECT_EQ(literal.at(0), 5);
  EXPECT_NEAR(literal.at(3.2189f), 5, 1e-4f);
  EXPECT_NEAR(literal.at(10), 148.41f, 0.01f);
}

/// How deep the particles lie behind the visible surface, m (d_t of Eq. 8). Computed back from the temporal
/// feature f_T, which is 1 / e^(d_t / 2) here: 1 over the attenuation.
std::vector<double> thicknesses(const std::vector<Vec4>& points, const View& view, const GBuffer& g) {
  std::vector<double> out;
  for (const auto& part : parts_of(points, one_eye(view, &g), 1)) {
    out.push_back(-2 * std::log(static_cast<double>(part.temporal)));
  }
  return out;
}

SIM_TEST(Occlusion, AParticleAloneIsNotHiddenByItself) {
  const View view = view_along_z(641, 481);
  for (const float scale : {1.0f, 1.5f}) {
    for (const float x : {0.0f, 0.7f, -1.3f}) {
      const std::vector<Vec4> alone{{x, 0.4f * x, -4, 0.3f}};
      EXPECT_NEAR(thicknesses(alone, view, splat(alone, view, scale))[0], 0, 1e-3) << x;
    }
  }
}

SIM_TEST(Occlusion, TheSecondOfTwoOnARayIsAsDeepAsTheyAreApart) {
  const View view = view_along_z(641, 481);
  for (const float scale : {1.0f, 1.5f}) {
    const std::vector<Vec4> two{{0, 0, -3, 0.3f}, {0, 0, -4.25f, 0.3f}};
    const auto d_t = thicknesses(two, view, splat(two, view, scale));
    EXPECT_NEAR(d_t[0], 0, 1e-3);
    EXPECT_NEAR(d_t[1], 1.25, 1e-3);
  }
}

SIM_TEST(Occlusion, OutOfViewIsCalmOrHiddenAndNoPictureIsOpen) {
  const View view = view_along_z(64, 48);
  const GBuffer g = picture_of(view, plane(3));
  Readings hidden;
  hidden.calm_out_of_view = false;
  for (const Vec4 unseen : {Vec4{40, 0, -3, 0.3f}, Vec4{0, 0, 3, 0.3f}}) {
    EXPECT_EQ(parts_of({unseen}, one_eye(view, &g), 1)[0].temporal, 0);
    EXPECT_EQ(parts_of({unseen}, one_eye(view, &g), 1, hidden)[0].temporal, 0.2f);
  }
  EXPECT_EQ(parts_of({{0, 0, -3, 0.3f}}, one_eye(view, nullptr), 1)[0].temporal, 1);
}

SIM_TEST(Features, CombineAsEquationOne) {
  const View view = view_along_z(641, 481);
  const GBuffer g = picture_of(view, ball(4, 1));
  Readings readings;
  readings.alpha = 0.25;
  const auto p = parts_of({{0.2f, 0.1f, -3.3f, 0.3f}}, one_eye(view, &g), 0.6f, readings)[0];
  ASSERT_GT(p.manifold, 0);
  ASSERT_GT(p.temporal, 0);
  EXPECT_NEAR(p.combined, 0.75f * (p.acuity + p.manifold) + 0.25f * p.temporal, 1e-6f);
}

SIM_TEST(Features, TheEyeThatSeesMoreCounts) {
  const View view = view_along_z(64, 48);
  const EyeLook left{{{0, 0, 0}, {-0.5, 0, -1}, true}, view, nullptr};
  const EyeLook right{{{0, 0, 0}, {0.5, 0, -1}, true}, view, nullptr};
  const std::vector<Vec4> points{{-1, 0, -2, 0.3f}, {1, 0, -2, 0.3f}, {0, 0, -2, 0.3f}};
  const auto by_left = parts_of(points, {{left}});
  const auto by_right = parts_of(points, {{right}});
  const auto by_both = parts_of(points, {{left, right}});
  ASSERT_GT(by_left[0].combined, by_right[0].combined);
  ASSERT_LT(by_left[1].combined, by_right[1].combined);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(by_both[i].combined, std::max(by_left[i].combined, by_right[i].combined));
  }
}

SIM_TEST(Looks, RefusesWhatCannotBeSeenWith) {
  const View view = view_along_z(8, 8);
  SaliencyInput input;
  EXPECT_THROW(input.look({}), base::Error);
  const EyeLook eye{{{0, 0, 0}, {0, 0, -1}, true}, view, nullptr};
  EXPECT_THROW(input.look({{eye, eye, eye}}), base::Error);
  GBuffer torn = picture_of(view, plane(2));
  torn.normal.pop_back();
  EXPECT_THROW(input.look(one_eye(view, &torn)), base::Error);
  View broken = view;
  broken.view[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(input.look(one_eye(broken, nullptr)), base::Error);
}

SIM_TEST(Looks, ALostGazeStaysAndThenFollowsTheView) {
  const View view = view_along_z(8, 8);
  SaliencyInput input;
  input.look(one_eye(view, nullptr, {2, 0, -2}));
  EXPECT_NEAR(input.next_frame(0.1, 0.25).eye[0].gaze.x, 0.70711f, 1e-5f);
  EXPECT_EQ(input.gaze_lost(), 0u);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3d lost[3] = {{nan, 0, -1}, {0, 0, 0}, {0, 1, 0}};
  for (int frame = 0; frame < 3; ++frame) {
    auto looks = one_eye(view, nullptr, lost[frame]);
    looks.eyes[0].gaze.valid = frame < 2;
    input.look(looks);
    const Vec3 gaze = input.next_frame(0.1, 0.25).eye[0].gaze;
    // A lost gaze is held for 0.1 and 0.2 s, then the view's axis replaces it.
    EXPECT_NEAR(gaze.x, frame < 2 ? 0.70711f : 0, 1e-5f) << frame;
    EXPECT_NEAR(gaze.z, frame < 2 ? -0.70711f : -1, 1e-5f) << frame;
  }
  EXPECT_EQ(input.gaze_lost(), 3u);
  input.look(one_eye(view, nullptr, {0, 3, -3}));
  EXPECT_NEAR(input.next_frame(0.1, 0.25).eye[0].gaze.y, 0.70711f, 1e-5f);
  EXPECT_EQ(input.gaze_lost(), 3u);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
