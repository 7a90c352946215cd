#include "libsim/neighbors/cell_key.hpp"
#include "libsim/neighbors/neighbour_list.hpp"

#ifndef SIM_CUDA
#include <omp.h>
#endif

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

struct Listed {
  std::vector<int> id;              // by slot
  std::vector<Vec4> position;       // by slot
  std::vector<std::set<int>> sets;  // by id
  std::uint64_t dropped = 0;
  int cells = 0;
  std::size_t entries = 0;
};

constexpr float finest = 0.3f;

/// The level of a support radius if level 0 has the support `finest`.
std::uint8_t level_of(float h) {
  return static_cast<std::uint8_t>(std::lround(3 * std::log2(static_cast<double>(h) / finest)));
}

Particles particles_at(const std::vector<Vec4>& points) {
  Particles particles;
  particles.allocate(
      columns(Column::Position, Column::Predicted, Column::Velocity, Column::Id, Column::Level),
      static_cast<int>(points.size()));
  particles.all().position.from_host(points);
  particles.all().predicted.from_host(points);
  std::vector<int> id(points.size());
  for (std::size_t i = 0; i < id.size(); ++i) id[i] = static_cast<int>(i);
  particles.all().id.from_host(id);
  particles.all().velocity.zero();
  particles.all().level.zero();
  return particles;
}

/// Tanks that hold all points, some, one or none of them.
const std::vector<Domain> domains{{{-4, -4, -4}, {4, 4, 4}},
                                  {{0, 0, 0}, {0.7f, 2, 1.1f}},
                                  {{-1, -1, -1}, {-1, -1, -1}},
                                  {{500, 500, 500}, {530, 530, 530}},
                                  {{-3e9f, -3e9f, -3e9f}, {3e9f, 3e9f, 3e9f}}};

/// Neighbour lists of points that all have the support radius of the first, or if `mixed`, of points of
/// several levels, of which level 0 has the support radius `finest`.
Listed list(const std::vector<Vec4>& points, const Domain& domain, bool reversed = false,
            bool mixed = false) {
  std::vector<Vec4> at = points;
  if (reversed) std::reverse(at.begin(), at.end());
  Particles particles = particles_at(at);
  if (reversed) {
    auto id = particles.all().id.to_host();
    std::reverse(id.begin(), id.end());
    particles.all().id.from_host(id);
  }
  if (mixed) {
    std::vector<std::uint8_t> level(points.size());
    std::transform(at.begin(), at.end(), level.begin(), [](Vec4 p) { return level_of(p.w); });
    particles.all().level.from_host(level);
  }
  Grid grid;
  NeighbourList neighbours;
  Array<Guards> guards(1);
  do {
    guards.zero();
    if (mixed) {
      grid.build(particles, NeighbourList::margin, domain, level_supports(static_cast<double>(finest)));
    } else {
      grid.build(particles, NeighbourList::margin, domain, points.empty() ? 1 : points[0].w);
    }
    neighbours.build(PredictedView(particles), grid, {guards.data(), particles.all().id.data(), 0});
  } while (neighbours.grow());

  Listed out;
  out.id = particles.all().id.to_host();
  out.position = particles.all().predicted.to_host();
  out.dropped = guards.to_host()[0].neighbours_dropped;
  out.cells = grid.count_cells();
  out.sets.resize(points.size());
  const auto lists = neighbours.lists();
  for (std::size_t i = 0; i < lists.size(); ++i) {
    for (const int j : lists[i]) {
      out.sets[static_cast<std::size_t>(out.id[i])].insert(out.id[static_cast<std::size_t>(j)]);
      ++out.entries;
    }
  }
  return out;
}

std::vector<std::set<int>> brute_force(const std::vector<Vec4>& points) {
  std::vector<std::set<int>> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Vec3 offset = xyz(points[i]) - xyz(points[j]);
      const float radius = NeighbourList::margin * 0.5f * (points[i].w + points[j].w);
      if (i != j && dot(offset, offset) < radius * radius) out[i].insert(static_cast<int>(j));
    }
  }
  return out;
}

void expect_brute_force(const std::vector<Vec4>& points, bool mixed = false) {
  const auto expected = brute_force(points);
  for (std::size_t d = 0; d < domains.size(); ++d) {
    SCOPED_TRACE("domain " + std::to_string(d));
    const Listed listed = list(points, domains[d], false, mixed);
    EXPECT_EQ(listed.dropped, 0u);
    std::size_t distinct = 0;
    for (const auto& set : listed.sets) distinct += set.size();
    EXPECT_EQ(listed.entries, distinct) << "an entry is listed twice";
    EXPECT_EQ(listed.sets, expected);
    EXPECT_EQ(list(points, domains[d], true, mixed).id, listed.id) << "the order depends on the order before";
  }
}

std::vector<Vec4> random_points(int n, float size, float h, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-size, size);
  std::vector<Vec4> out;
  for (int i = 0; i < n; ++i) out.push_back({coordinate(random), coordinate(random), coordinate(random), h});
  return out;
}

SIM_TEST(S14NeighbourList, EqualsBruteForceOnRandomPoints) {
  for (const float size : {0.2f, 1.0f, 3.0f})
    expect_brute_force(random_points(size < 0.5f ? 200 : 1500, size, 0.3f, 7));
}

/// Assigns `levels` to the points in turn.
std::vector<Vec4> mixed_points(std::vector<Vec4> points, const std::vector<int>& levels) {
  const auto supports = level_supports(static_cast<double>(finest));
  for (std::size_t i = 0; i < points.size(); ++i) points[i].w = supports.h[levels[i % levels.size()]];
  return points;
}

SIM_TEST(S14MixedNeighbourList, EqualsBruteForceOnRandomPoints) {
  for (const auto& levels : std::vector<std::vector<int>>{
           {0, 1, 2, 3}, {0, 3}, {1, 2}, {3, 3, 3, 0}, {0}, {3}, {2, 0, 0, 0, 0, 0, 0}}) {
    for (const float size : {0.3f, 1.2f, 4.0f}) {
      expect_brute_force(mixed_points(random_points(size < 1 ? 300 : 1500, size, finest, 7), levels), true);
    }
  }
}

SIM_TEST(S14MixedNeighbourList, EqualsBruteForceOnCellPlanes) {
  // Lattice points on the planes of the finest cells and of those twice as wide.
  const float edge = NeighbourList::margin * finest;
  std::vector<Vec4> points;
  for (int i = 0; i < 1000; ++i) {
    points.push_back({static_cast<float>(i % 10 - 5) * edge, static_cast<float>(i / 10 % 10 - 5) * edge,
                      static_cast<float>(i / 100 - 5) * edge, finest});
  }
  expect_brute_force(mixed_points(points, {0, 3, 0, 1, 2}), true);
}

SIM_TEST(S14MixedNeighbourList, EqualsBruteForceInOneCellAndFarApart) {
  expect_brute_force(mixed_points(random_points(300, 0.05f, finest, 3), {0, 1, 2, 3}), true);
  std::vector<Vec4> points;
  for (const float far : {-1e9f, -6.9e5f, -6e5f, -3.4e5f, 0.0f, 3.4e5f, 6e5f, 6.9e5f, 1e9f}) {
    for (int i = 0; i < 12; ++i)
      points.push_back({far, far > 0 ? far : 0.1f * static_cast<float>(i), -far, finest});
  }
  expect_brute_force(mixed_points(points, {0, 1, 2, 3}), true);
  // Fine and coarse points beyond their grids.
  expect_brute_force(mixed_points({{1.0e6f, 0, 0, 0}, {1.0e6f, 0.2f, 0, 0}, {1.0e6f, 0.4f, 0, 0}}, {3, 0}),
                     true);
}

SIM_TEST(S14MixedNeighbourList, TakesNoneOneAndThin) {
  expect_brute_force({}, true);
  expect_brute_force(mixed_points({{1, 2, 3, 0}}, {2}), true);
  // A coarse particle over a line of fine ones that crosses many cells.
  std::vector<Vec4> points;
  for (int i = 0; i < 200; ++i) points.push_back({0.01f * static_cast<float>(i), 0, 0, finest});
  auto mixed = mixed_points(points, {0});
  mixed.push_back({1, 0.3f, 0.1f, level_supports(static_cast<double>(finest)).h[3]});
  expect_brute_force(mixed, true);
}

SIM_TEST(S14NeighbourList, EqualsBruteForceOnCellPlanes) {
  // Lattice points that lie exactly on the planes of the cells.
  std::vector<Vec4> points;
  const float h = 0.25f;
  for (int i = 0; i < 1000; ++i) {
    points.push_back({static_cast<float>(i % 10 - 5) * 0.275f, static_cast<float>(i / 10 % 10 - 5) * 0.275f,
                      static_cast<float>(i / 100 - 5) * 0.275f, h});
  }
  expect_brute_force(points);
}

SIM_TEST(S14NeighbourList, EqualsBruteForceInOneCellAndFarApart) {
  expect_brute_force(random_points(300, 0.05f, 0.3f, 3));
  // Points beyond every tank.
  std::vector<Vec4> points;
  for (const float far : {-1e9f, -6e5f, 0.0f, 6e5f, 1e9f}) {
    for (int i = 0; i < 5; ++i) points.push_back({far, 0.1f * static_cast<float>(i), -far, 0.3f});
  }
  expect_brute_force(points);
}

#ifndef SIM_CUDA
/// libsim/neighbors/candidates.hpp caches for each thread the particles of the window of cells that it
/// searched last. One thread builds lists of two simulations in turn, and particles move within their cells
/// between builds: the windows are the cached ones, but the particles in them are not.
SIM_TEST(S14NeighbourList, OfTwoSimulationsInOneThreadAreTheirOwn) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  // All points are in the middle one of 27 cells, whose width is a little above `edge`, the reach of a list.
  const Domain tank{{0, 0, 0}, {1, 1, 1}};
  const float edge = NeighbourList::margin * finest;
  const auto points_of = [&](unsigned seed) {
    std::vector<Vec4> out = random_points(40, 0.47f * edge, finest, seed);
    for (Vec4& p : out) p = {p.x + 1.5f * edge, p.y + 1.5f * edge, p.z + 1.5f * edge, p.w};
    return out;
  };
  struct One {
    Particles particles;
    Grid grid;
    NeighbourList neighbours;
  };
  One simulations[2];
  Array<Guards> guards(1);
  guards.zero();
  unsigned seed = 1;
  for (int turn = 0; turn < 3; ++turn) {
    for (One& one : simulations) {
      const std::vector<Vec4> points = points_of(seed++);
      one.particles = particles_at(points);
      do {
        one.grid.build(one.particles, NeighbourList::margin, tank, finest);
        one.neighbours.build(PredictedView(one.particles), one.grid,
                             {guards.data(), one.particles.all().id.data(), 0});
      } while (one.neighbours.grow());
      const auto id = one.particles.all().id.to_host();
      const auto lists = one.neighbours.lists();
      std::vector<std::set<int>> found(points.size());
      for (std::size_t i = 0; i < lists.size(); ++i) {
        for (const int j : lists[i])
          found[static_cast<std::size_t>(id[i])].insert(id[static_cast<std::size_t>(j)]);
      }
      EXPECT_EQ(found, brute_force(points));
    }
  }
  omp_set_num_threads(threads);
}
#endif

/// Lists after one build, with the space that a new NeighbourList has: nothing has grown.
struct FirstBuild {
  Particles particles;
  Grid grid;
  NeighbourList neighbours;
  Array<Guards> guards{1};

  explicit FirstBuild(const std::vector<Vec4>& points) : particles(particles_at(points)) {
    grid.build(particles, NeighbourList::margin, domains[0], points[0].w);
    guards.zero();
    neighbours.build(PredictedView(particles), grid, {guards.data(), particles.all().id.data(), 0});
  }
};

SIM_TEST(S14NeighbourList, PutsListsWithoutRoomInTheStore) {
  // On the first build a list has room for some 55 neighbours; longer lists go to a store common to all.
  // Nothing grows, because there is only one build.
  std::vector<Vec4> points = random_points(400, 0.05f, 0.3f, 3);
  const std::vector<Vec4> few = random_points(40, 0.05f, 0.3f, 4);
  for (const Vec4& p : few) points.push_back({p.x + 7, p.y, p.z, p.w});
  const FirstBuild first(points);
  EXPECT_EQ(first.guards.to_host()[0].neighbours_dropped, 0u);
  const auto id = first.particles.all().id.to_host();
  const auto lists = first.neighbours.lists();
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const std::set<int> distinct(lists[i].begin(), lists[i].end());
    EXPECT_EQ(distinct.size(), lists[i].size());
    EXPECT_EQ(lists[i].size(), id[i] < 400 ? 399u : 39u);
    EXPECT_FALSE(distinct.contains(static_cast<int>(i)));
  }
}

SIM_TEST(S14NeighbourList, CountsWhatFindsNoRoomInTheStoreEither) {
  // 1,500 coincident points need 2.2 million entries; the store starts with 1 million.
  const std::vector<Vec4> points(1500, Vec4{1, 1, 1, 0.3f});
  FirstBuild first(points);
  std::size_t listed = 0;
  for (const auto& one : first.neighbours.lists()) listed += one.size();
  EXPECT_GT(first.guards.to_host()[0].neighbours_dropped, 0u);
  EXPECT_EQ(listed + first.guards.to_host()[0].neighbours_dropped, 1500u * 1499u);
  EXPECT_TRUE(first.neighbours.grow());
  const Listed grown = list(points, domains[0]);
  EXPECT_EQ(grown.dropped, 0u);
  EXPECT_EQ(grown.cells, 1);
  EXPECT_EQ(grown.entries, 1500u * 1499u);
}

SIM_TEST(S14NeighbourList, TakesNoneAndOne) {
  expect_brute_force({});
  expect_brute_force({{1, 2, 3, 0.1f}});
  expect_brute_force({{0, 0, 0, 0.1f}, {0.101f, 0, 0, 0.1f}});
}

SIM_TEST(S14Grid, HasFewCellsInAnyTank) {
  Particles particles = particles_at(random_points(100, 1, finest, 5));
  for (const Domain& domain : domains) {
    Grid grid;
    grid.build(particles, NeighbourList::margin, domain, finest);
    EXPECT_LE(grid.size(), Grid::always);
    grid.build(particles, NeighbourList::margin, domain, level_supports(static_cast<double>(finest)));
    EXPECT_LE(grid.size(), Grid::always);
  }
}

/// After all water has left, the grid has no cells; foam reads it (libsim/foam/water_round.hpp).
SIM_TEST(S14Grid, IsEmptyAfterTheLastParticleLeft) {
  for (const bool one_level : {true, false}) {
    Particles particles = particles_at(random_points(100, 1, finest, 5));
    Grid grid;
    const auto build = [&] {
      if (one_level) {
        grid.build(particles, NeighbourList::margin, domains[0], finest);
      } else {
        grid.build(particles, NeighbourList::margin, domains[0], level_supports(static_cast<double>(finest)));
      }
    };
    build();
    EXPECT_GT(grid.count_cells(), 1);
    particles.resize(0);
    build();
    EXPECT_EQ(grid.count_cells(), 0);
  }
}

/// Shared ids are not allowed, but even then no particle is lost.
SIM_TEST(S14Grid, KeepsEveryoneWhereIdsAreShared) {
  std::vector<Vec4> points = random_points(200, 0.1f, finest, 5);
  Particles particles = particles_at(points);
  particles.all().id.zero();
  Grid grid;
  grid.build(particles, NeighbourList::margin, domains[0], finest);
  std::multiset<float> before;
  std::multiset<float> after;
  for (const Vec4& p : points) before.insert(p.x);
  for (const Vec4& p : particles.all().predicted.to_host()) after.insert(p.x);
  EXPECT_EQ(after, before);
}

SIM_TEST(S14CellKey, KeepsItsFields) {
  for (const int x : {-cell_limit_xz, -1, 0, 5, cell_limit_xz - 1}) {
    for (const int y : {-cell_limit_y, -1, 0, cell_limit_y - 1}) {
      const auto c = cell_of_key(cell_key({3, x, y, -x - 1}));
      EXPECT_EQ(c.x, x);
      EXPECT_EQ(c.y, y);
      EXPECT_EQ(c.z, -x - 1);
      EXPECT_EQ(c.level, 3);
    }
  }
}

}  // namespace
}  // namespace sim::SIM_BACKEND
