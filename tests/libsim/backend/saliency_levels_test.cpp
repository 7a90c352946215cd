/// Saliency s and levels that follow from the combined feature F, levels by gaze alone, and the gradients of
/// Eq. 6 of the paper.

#include <random>

#include "tests/libsim/backend/saliency_helpers.hpp"

namespace sim::SIM_BACKEND {
namespace {

using namespace saliency_test;

struct Judged {
  std::vector<float> s;
  std::vector<int> levels;
  std::uint64_t not_finite;
  SaliencyRange range;
};

/// Saliency s and levels of particles with the combined features F; before, their levels are 2 and s is
/// 0.625.
Judged judge(const std::vector<float>& F, SaliencyNormaliser& normaliser, Normalisation reading) {
  const int n = static_cast<int>(F.size());
  Array<float> combined, s;
  combined.from_host(F);
  s.from_host(std::vector<float>(F.size(), 0.625f));
  Array<std::uint8_t> target;
  target.from_host(std::vector<std::uint8_t>(F.size(), 2));
  Array<Guards> guards(1);
  guards.zero();
  Array<std::uint8_t> own;
  own.from_host(std::vector<std::uint8_t>(F.size(), 0));
  normaliser.update(combined, own.data(), n, reading);
  saliency_to_levels(combined.data(), normaliser.range(), 4, s.data(), target.data(), guards.data(), {}, n);
  const auto levels = target.to_host();
  SaliencyRange range;
  copy_to_host(&range, normaliser.range(), sizeof range);
  return {s.to_host(), {levels.begin(), levels.end()}, guards.to_host()[0].saliency_not_finite, range};
}
Judged judge(const std::vector<float>& F, Normalisation reading) {
  SaliencyNormaliser normaliser;
  return judge(F, normaliser, reading);
}

std::vector<float> spread(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::lognormal_distribution<float> value(-1, 1.5f);
  std::vector<float> out(n);
  for (float& v : out) v = value(random);
  return out;
}

SIM_TEST(SaliencyLevels, EdgesAreThoseOfEquationNine) {
  EXPECT_EQ(level_of_saliency(1, 4), 0);
  EXPECT_EQ(level_of_saliency(0.751f, 4), 0);
  EXPECT_EQ(level_of_saliency(0.75f, 4), 1);
  EXPECT_EQ(level_of_saliency(0.501f, 4), 1);
  EXPECT_EQ(level_of_saliency(0.5f, 4), 2);
  EXPECT_EQ(level_of_saliency(0.25f, 4), 3);
  EXPECT_EQ(level_of_saliency(0, 4), 3) << "s = 0 would be level N without the clamp";
  for (const float s : {0.0f, 0.5f, 1.0f}) EXPECT_EQ(level_of_saliency(s, 1), 0);
}

SIM_TEST(SaliencyLevels, PercentilesAreExact) {
  for (const std::size_t n : {2u, 3u, 101u, 5000u}) {
    auto F = spread(n, 17);
    const auto range = judge(F, Normalisation::Percentile).range;
    std::sort(F.begin(), F.end());
    EXPECT_EQ(range.low, F[(n - 1) / 100]) << n;
    EXPECT_EQ(range.high, F[n - 1 - (n - 1) * 2 / 100]) << n;
    const auto ends = judge(F, Normalisation::MinMax).range;
    EXPECT_EQ(ends.low, F.front()) << n;
    EXPECT_EQ(ends.high, F.back()) << n;
  }
}

SIM_TEST(SaliencyLevels, PercentilesAreSharesOfTheWaterNotOfTheParticles) {
  // One particle of level 3 holds as much water as eight of level 0 at the same place.
  auto divided = spread(800, 23);
  std::sort(divided.begin(), divided.end());
  std::vector<float> whole;
  std::vector<std::uint8_t> level;
  for (std::size_t i = 0; i < divided.size(); i += 8) {
    std::fill_n(divided.begin() + static_cast<std::ptrdiff_t>(i), 8, divided[i]);
    whole.push_back(divided[i]);
    level.push_back(3);
  }
  Array<float> values;
  Array<std::uint8_t> levels;
  values.from_host(whole);
  levels.from_host(level);
  SaliencyNormaliser normaliser;
  normaliser.update(values, levels.data(), static_cast<int>(whole.size()), Normalisation::Percentile);
  SaliencyRange range;
  copy_to_host(&range, normaliser.range(), sizeof range);
  const auto fine = judge(divided, Normalisation::Percentile).range;
  EXPECT_EQ(range.low, fine.low);
  EXPECT_EQ(range.high, fine.high);
}

SIM_TEST(SaliencyLevels, WhereNothingStandsOutNothingIsFullySalient) {
  const std::vector<float> calm{0.01f, 0.02f, 0.03f, 0.04f};
  Array<float> values;
  Array<std::uint8_t> levels;
  values.from_host(calm);
  levels.from_host(std::vector<std::uint8_t>(calm.size(), 0));
  SaliencyNormaliser normaliser;
  normaliser.update(values, levels.data(), static_cast<int>(calm.size()), Normalisation::Percentile, 0.1f,
                    0.1f);
  SaliencyRange range;
  copy_to_host(&range, normaliser.range(), sizeof range);
  EXPECT_EQ(range.high, 0.1f);
}

SIM_TEST(SaliencyLevels, DropsDoNotMerge) {
  // All but the last have the least saliency, so that Eq. 9 wants level 3; of the last it wants level 0.
  const auto targets = [](float below) {
    Array<float> combined, s, density;
    combined.from_host({0, 0, 0, 0, 0, 1});
    s.from_host({0, 0, 0, 0, 0, 0});
    density.from_host({0.2f, 0.39f, 0.4f, 0.9f, 0.2f, 0.2f});
    Array<std::uint8_t> level, target;
    level.from_host({0, 1, 0, 0, 3, 3});
    target.from_host({9, 9, 9, 9, 9, 9});
    Array<SaliencyRange> range(1);
    range.from_host({SaliencyRange{0, 1, 1, 1}});
    Array<Guards> guards(1);
    guards.zero();
    saliency_to_levels(combined.data(), range.data(), 4, s.data(), target.data(), guards.data(),
                       {density.data(), level.data(), below}, 6);
    const auto found = target.to_host();
    return std::vector<int>(found.begin(), found.end());
  };
  EXPECT_EQ(targets(0.4f), (std::vector<int>{0, 1, 3, 3, 3, 0}));
  EXPECT_EQ(targets(0), (std::vector<int>{3, 3, 3, 3, 3, 0}));
  EXPECT_EQ(readings_of(Preset::Paper).drop_density, 0);
}

SIM_TEST(SaliencyLevels, AnOutlierChangesAlmostNothing) {
  auto F = spread(4000, 3);
  const auto changed_by_outlier = [&](Normalisation reading) {
    auto with = F;
    with.push_back(1e6f * *std::max_element(F.begin(), F.end()));
    const auto a = judge(F, reading).levels, b = judge(with, reading).levels;
    int changed = 0;
    for (std::size_t i = 0; i < a.size(); ++i) changed += a[i] != b[i];
    return changed;
  };
  EXPECT_LT(changed_by_outlier(Normalisation::Percentile), 40);
  // With MinMax (the literal reading) one outlier flattens all other values, so it is not the default.
  auto even = std::vector<float>();
  for (int i = 0; i < 4000; ++i) even.push_back(static_cast<float>(i));
  F = even;
  EXPECT_LT(changed_by_outlier(Normalisation::Percentile), 40);
  EXPECT_GT(changed_by_outlier(Normalisation::MinMax), 2000);
}

SIM_TEST(SaliencyLevels, WithoutASpreadTheyStay) {
  for (const auto reading : {Normalisation::Percentile, Normalisation::MinMax}) {
    for (const auto& F : {std::vector<float>(50, 0.7f), std::vector<float>{3}, std::vector<float>(9, 0.0f)}) {
      const auto judged = judge(F, reading);
      for (std::size_t i = 0; i < F.size(); ++i) {
        EXPECT_EQ(judged.levels[i], 2);
        EXPECT_EQ(judged.s[i], 0.625f);
      }
    }
    EXPECT_TRUE(judge({}, reading).levels.empty());
  }
}

SIM_TEST(SaliencyLevels, WhatIsNotFiniteIsLeastSalientAndCounted) {
  auto F = spread(1000, 5);
  const auto clean = judge(F, Normalisation::MinMax);
  F.push_back(std::numeric_limits<float>::quiet_NaN());
  F.push_back(std::numeric_limits<float>::infinity());
  const auto judged = judge(F, Normalisation::MinMax);
  EXPECT_EQ(judged.not_finite, 2u);
  EXPECT_EQ(judged.s[1000], 0);
  EXPECT_EQ(judged.levels[1000], 3);
  EXPECT_EQ(judged.levels[1001], 3);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(judged.levels[i], clean.levels[i]);
}

SIM_TEST(SaliencyLevels, TheRangeFollowsByATenthAFrame) {
  SaliencyNormaliser normaliser;
  const std::vector<float> before{1, 2}, after{2, 12};
  judge(before, normaliser, Normalisation::Percentile);
  const auto next = judge(after, normaliser, Normalisation::Percentile).range;
  EXPECT_NEAR(next.low, 1.1f, 1e-6f);
  EXPECT_NEAR(next.high, 3, 1e-6f);
  const auto literal = judge(before, normaliser, Normalisation::MinMax).range;
  EXPECT_EQ(literal.low, 1);
  EXPECT_EQ(literal.high, 2);
}

SIM_TEST(GazeLevels, AreFinestInTheConeAndCoarsestBeyondItsBand) {
  const View view = view_along_z(8, 8);
  std::vector<Vec4> points;
  const double fovea = 7.5 * 0.017453292519943;
  // 4 m away: steps of a tenth of the coarse support, 0.6 m, outwards from the cone's wall; then behind the
  // eye.
  for (int k = -5; k <= 15; ++k) {
    const double theta = fovea + std::asin(0.06 * (k + 0.01) / 4);
    points.push_back(
        {static_cast<float>(4 * std::sin(theta)), 0, static_cast<float>(-4 * std::cos(theta)), 0.3f});
  }
  points.push_back({0, 0, 4, 0.3f});
  Fluid fluid = fluid_of(points, std::vector<Vec4>(points.size(), Vec4{0, 0, 0, 0}), {}, 0.3f);
  // The sort has changed the order, so compare by place.
  fluid.saliency.input.look({{{{{0, 0, 0}, {0, 0, -1}, true}, view, nullptr}}});
  fluid.saliency.look_around(1.0 / 60);
  evaluate_gaze(fluid.saliency, fluid.view());
  const auto places = fluid.points();
  const auto levels = fluid.levels();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double theta =
        std::atan2(std::abs(static_cast<double>(places[i].x)), -static_cast<double>(places[i].z));
    const double beyond = 4 * std::sin(std::min(theta - fovea, 1.5)) / 0.6;
    EXPECT_EQ(levels[i], beyond <= 0 ? 0 : std::min(3, static_cast<int>(4 * beyond))) << beyond;
  }
}

double norm_of_gradients(const std::vector<Vec4>& x, const std::vector<Vec4>& v,
                         const std::vector<float>& rho, std::size_t i, double epsilon_v) {
  // Eq. 6 within 2 h_i, term by term: spiky gradient with support 2 h_i.
  double g[4][3] = {};
  const double support = 2 * static_cast<double>(x[i].w);
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double d[3] = {static_cast<double>(x[i].x) - static_cast<double>(x[j].x),
                         static_cast<double>(x[i].y) - static_cast<double>(x[j].y),
                         static_cast<double>(x[i].z) - static_cast<double>(x[j].z)};
    const double r = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (j == i || r >= support) continue;
    const double slope = 45 / (3.14159265358979 * 1.0098 * std::pow(support, 6)) * std::pow(support - r, 2);
    const double volume = std::pow(static_cast<double>(x[j].w) / 2, 3) / static_cast<double>(rho[j]);
    const double step[4] = {static_cast<double>(rho[j]) - static_cast<double>(rho[i]),
                            static_cast<double>(v[j].x) - static_cast<double>(v[i].x),
                            static_cast<double>(v[j].y) - static_cast<double>(v[i].y),
                            static_cast<double>(v[j].z) - static_cast<double>(v[i].z)};
    for (int q = 0; q < 4; ++q)
      for (int a = 0; a < 3; ++a) g[q][a] -= volume * slope * step[q] * d[a] / r;
  }
  double density = 0, velocity = 0;
  for (int a = 0; a < 3; ++a) {
    density += g[0][a] * g[0][a];
    for (int q = 1; q < 4; ++q) velocity += g[q][a] * g[q][a];
  }
  const double speed = std::sqrt(static_cast<double>(v[i].x * v[i].x + v[i].y * v[i].y + v[i].z * v[i].z));
  return static_cast<double>(x[i].w) * (std::sqrt(density) / (static_cast<double>(rho[i]) + 1e-3) +
                                        std::sqrt(velocity) / (speed + epsilon_v));
}

SIM_TEST(Gradients, WithinTwoSupportsAreThoseOfBruteForce) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> at(-1, 2), speed(-1, 1), rho(0.3f, 1.1f);
  std::vector<Vec4> x, v;
  std::vector<float> density;
  for (int i = 0; i < 700; ++i) {
    x.push_back({at(random), at(random), at(random), 0.3f * std::exp2(static_cast<float>(i % 4) / 3)});
    v.push_back({speed(random), speed(random), speed(random), 0});
    density.push_back(rho(random));
  }
  Array<Vec4> position, velocity;
  position.from_host(x);
  velocity.from_host(v);
  Array<float> densities, out(x.size());
  densities.from_host(density);
  TemporalGradients gradients;
  gradients.run(GradientReach::TwoSupports,
                {position.data(), velocity.data(), densities.data(), out.data(), 1e-3f, 0.12f, true}, {}, 700,
                0.3f);
  const auto found = out.to_host();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = norm_of_gradients(x, v, density, i, 0.12);
    EXPECT_NEAR(static_cast<double>(found[i]), expected, 2e-4 * expected) << i;
  }
}

/// A cubic lattice of spacing 0.15 m, a little disturbed.
std::vector<Vec4> lattice(int nx, int ny, int nz, unsigned seed, float jitter) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> off(-jitter, jitter);
  std::vector<Vec4> out;
  for (int i = 0; i < nx * ny * nz; ++i) {
    const auto place = [&](int k) { return 0.15f * (static_cast<float>(k) + 0.5f + off(random)); };
    const float x = place(i % nx), y = place(i / nx / nz), z = place(i / nx % nz);
    out.push_back({x, y, z, 0.3f});
  }
  return out;
}

SIM_TEST(Gradients, OfALinearFlowAreItsRate) {
  // v = (0.4 y, 0, 0): |grad v| = 0.4 1/s inside the fluid, as well as the neighbours resolve it.
  const auto points = lattice(16, 16, 16, 1, 0.05f);
  std::vector<Vec4> velocity;
  for (const auto& p : points) velocity.push_back({0.4f * p.y, 0, 0, 0});
  Fluid fluid = fluid_of(points, velocity, {}, 0.3f);
  // The sort reordered the columns together with the particles.
  auto& p = fluid.state.particles;
  Array<float> uniform, out(points.size());
  uniform.from_host(std::vector<float>(points.size(), 1));
  const auto place = p.all().position.to_host(), speed = p.all().velocity.to_host();
  for (const auto reach : {GradientReach::OneSupport, GradientReach::Smoothed, GradientReach::TwoSupports}) {
    TemporalGradients gradients;
    gradients.run(
        reach,
        {p.all().position.data(), p.all().velocity.data(), uniform.data(), out.data(), 1e-3f, 1, false},
        fluid.state.particle_neighbours(), p.size(), 0.3f);
    const auto found = out.to_host();
    int inside = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      // Farther from the block's faces than the gradients reach.
      const auto deep = [](float c) { return c > 0.95f && c < 1.45f; };
      if (!deep(place[i].x) || !deep(place[i].y) || !deep(place[i].z)) continue;
      EXPECT_NEAR(found[i] * (std::abs(speed[i].x) + 1), 0.4f, 0.15f * 0.4f) << static_cast<int>(reach);
      ++inside;
    }
    EXPECT_GE(inside, 27);
  }
}

}  // namespace
}  // namespace sim::SIM_BACKEND
