#pragma once
/// Contacts between rigid bodies: a substep of all bodies in one block of threads.

#include "libsim/exec/one_block.hpp"
#include "libsim/particles/contact.hpp"
#include "libsim/particles/contact_rows.hpp"
#include "libsim/particles/free_body.hpp"

namespace sim::SIM_BACKEND {

/// The two sides of a contact: two bodies, or one body and a wall.
struct Partners {
  int first, second;  ///< second < 0: the wall ~second
};

/// A contact that is solved, and its two sides.
struct ListedContact {
  Contact contact;
  Partners between;
};

/// Moves free bodies to their positions at the substep's end. Contacts are inelastic, with Coulomb friction;
/// they are detected at the bodies' positions at the substep's start. Pushes stop surfaces at each other;
/// penetration is corrected in position only. Each sweep over the contacts ends with those of walls.
struct Meeting {
  Body* bodies;  ///< bodies that are not free are already at their positions of the substep's end
  FreeBody* free;
  const MeshGrid* meshes;  ///< of all bodies; nullptr: no body is a mesh
  const float* friction;   ///< friction coefficient of each body
  /// momentum that each body received from other bodies in this frame, m_* m/s with m_* the mass of a
  /// particle of level 0
  Vec3* by_others;
  Walls walls;
  BodyDrive drive;
  float spacing;  ///< of the finest particles, m
  int count;
  int feelers;  ///< largest number of points (Feelers) of one body
  bool rough;   ///< true if at least one body has friction

  /// slop: penetration that remains uncorrected; fastest_mend: maximum correction per substep. Both are
  /// shares of the finest spacing.
  static constexpr float slop = 1e-3f, fastest_mend = 0.1f;
  /// Share of the penetration beyond slop that a substep corrects.
  static constexpr float mended = 0.5f;
  /// First term of pad(), the distance below which contacts are solved, as a share of the smaller body's
  /// radius (Feelers::reach).
  static constexpr float wide = 0.02f;

  SIM_FN int width() const { return rough ? 3 : 1; }
  SIM_FN int pairs() const { return count * (count - 1) / 2; }
  SIM_FN int groups() const { return pairs() + count * walls.count; }
  /// The two sides of the contacts of one group. Groups of two bodies come first, then those of each body
  /// with each wall.
  SIM_FN Partners partners(int group) const {
    if (group >= pairs()) {
      const int k = group - pairs();
      return {k / walls.count, ~(k % walls.count)};
    }
    int first = 0;
    for (; group >= count - 1 - first; ++first) group -= count - 1 - first;
    return {first, first + 1 + group};
  }

  struct Room {
    std::size_t bytes = 0;
    Body* start;      ///< bodies at the beginning of the substep
    BodyRate* rates;  ///< the bodies' velocities, at first without contacts
    BodyRate* along;  ///< per body: velocity change per step of the conjugate gradients
    float* speeds;    ///< speed of the fastest point of each body, m/s
    int* found;     ///< number of contacts per group; for two bodies first a flag: 1 = a contact is possible
    Contact* felt;  ///< per pair of bodies: one contact for each tested point of either body
    Contact* picked;  ///< selected contacts, up to most_contacts per group
    ListedContact* list;
    int* listed;                 ///< number of listed contacts
    int *touches, *touch_begin;  ///< the listed contacts of each body, see ContactRows
    ContactProgress* progress;
    int* deep;        ///< 1 if some penetration exceeds slop
    float* friction;  ///< coefficient of each listed contact
    ContactRow* rows;
  };
  /// Divides the scratch memory into the arrays of Room; with nullptr it computes only their total size.
  SIM_FN Room parts_of(unsigned char* room) const {
    const auto n = static_cast<std::size_t>(count);
    const auto most = static_cast<std::size_t>(groups() * most_contacts);
    Room out;
    take(room, out.bytes, out.start, n);
    take(room, out.bytes, out.rates, n);
    take(room, out.bytes, out.along, n);
    take(room, out.bytes, out.speeds, n);
    take(room, out.bytes, out.found, static_cast<std::size_t>(groups()));
    take(room, out.bytes, out.felt, static_cast<std::size_t>(2 * pairs() * feelers));
    take(room, out.bytes, out.picked, most);
    take(room, out.bytes, out.list, most);
    take(room, out.bytes, out.listed, 1);
    take(room, out.bytes, out.touches, 2 * most);
    take(room, out.bytes, out.touch_begin, n + 1);
    take(room, out.bytes, out.progress, 1);
    take(room, out.bytes, out.deep, 1);
    take(room, out.bytes, out.friction, most);
    take(room, out.bytes, out.rows, most * static_cast<std::size_t>(width()));
    return out;
  }
  std::size_t bytes() const { return parts_of(nullptr).bytes; }

  struct InRoom {
    const Meeting& m;
    Room room;

    template <void (InRoom::*step)(int) const>
    struct Step {
      const InRoom& here;
      SIM_FN void operator()(int i) const { (here.*step)(i); }
    };

    SIM_FN bool is_free(int b) const { return m.free[b].mass > 0; }
    SIM_FN bool is_ball(int b) const { return !mesh_of(m.meshes, b) && feelers_of(b).count() == 1; }
    SIM_FN Feelers feelers_of(int b) const { return {room.start[b], mesh_of(m.meshes, b)}; }
    SIM_FN Solids solids() const { return {m.walls, room.start, m.count, m.drive.dt, m.meshes}; }
    SIM_FN Vec3 velocity_at(int b, Vec3 x) const {
      return room.rates[b].velocity + cross(room.rates[b].spin, x - room.start[b].centre);
    }

    /// Sets the position and the velocities of body b at the substep's start. A free body's velocities
    /// already include the changes by gravity and the water (BodyDrive).
    SIM_FN void begin(int b) const {
      if (m.drive.first) m.by_others[b] = {0, 0, 0};
      Body body = m.bodies[b];
      FreeBody& it = m.free[b];
      if (is_free(b)) {
        m.drive(it);
        room.rates[b] = {(1 / it.mass) * it.momentum, spin_of(it, body.turn, it.spin), 1 / it.mass};
      } else {
        room.rates[b] = {body.velocity, body.spin, 0};
        body.centre += -m.drive.dt * body.velocity;
        body.turn = turned_by(body.turn, -m.drive.dt * body.spin);
      }
      room.start[b] = body;
      room.speeds[b] = length(room.rates[b].velocity) + length(room.rates[b].spin) * feelers_of(b).reach();
    }

    SIM_FN float fastest() const {
      float out = 0;
      for (int b = 0; b < m.count; ++b) out = at_least(room.speeds[b], out);
      return out;
    }
    /// Upper bound of the push between two bodies, m_* m/s with m_* the mass of a particle of level 0. In a
    /// wedge of half angle a pushes grow as 1 / (2 sin a); the bound suffices down to 2 degrees. Pushes from
    /// walls have no bound and come last in each sweep, so that a body pinned between bodies and a wall stays
    /// in the tank.
    SIM_FN float most_push(float speed) const {
      float mass = 0;
      for (int b = 0; b < m.count; ++b) mass += m.free[b].mass;
      return 16 * mass * speed;
    }

    /// A contact is solved only if its Contact::ahead is below this distance, m.
    SIM_FN float pad(Partners pair) const {
      float size = feelers_of(pair.first).reach();
      if (pair.second >= 0) size = at_most(feelers_of(pair.second).reach(), size);
      // The second term is needed if a body is struck in this substep and then hits another body.
      return wide * size + 0.25f * m.drive.dt * fastest();
    }
    SIM_FN void screen(int group) const {
      const auto [a, b] = m.partners(group);
      const float speed = room.speeds[a] + room.speeds[b];
      const float far = pad({a, b}) + m.drive.dt * speed;
      room.found[group] = (is_free(a) || is_free(b)) && reaches(a, b, far) && reaches(b, a, far);
    }
    SIM_FN bool reaches(int a, int b, float far) const {
      const float reach = feelers_of(a).reach() + far;
      const Vec3 centre = room.start[a].centre;
      if (length(centre - room.start[b].centre) > reach + feelers_of(b).reach()) return false;
      // Outside its grid, a mesh's distance may exceed the true distance, so a mesh always passes this test.
      return mesh_of(m.meshes, b) || room.start[b].distance(centre) <= reach;
    }

    /// Sets `ahead`: the gap minus the distance by which the surfaces approach in the substep. For separating
    /// surfaces this distance counts as 0, because other bodies may stop the separation.
    SIM_FN void look_ahead(Contact& it, Vec3 speed) const {
      it.ahead = it.gap + m.drive.dt * at_most(dot(it.normal, speed), 0.0f);
    }
    /// Tests one point (Feelers) of one body of a pair for contact with the other body.
    SIM_FN void feel(int k) const {
      const int group = k / (2 * m.feelers);
      if (!room.found[group]) return;
      const Partners pair = m.partners(group);
      const bool back = k / m.feelers % 2;
      const int self = back ? pair.second : pair.first;
      const int other = back ? pair.first : pair.second;
      const Feelers own = feelers_of(self);
      Contact& out = room.felt[k];
      out.ahead = 3e38f;
      if (k % m.feelers >= own.count() || spares(other, self, back)) return;
      out = own.meets(k % m.feelers, solids(), other);
      look_ahead(out, velocity_at(self, out.at) - velocity_at(other, out.at));
      if (back) out.normal = -1.0f * out.normal;
    }
    /// True if the points of `self` need no test: if one body is a ball, testing its centre suffices.
    SIM_FN bool spares(int other, int self, bool back) const {
      return is_ball(self) && is_ball(other) ? back : is_ball(other);
    }

    struct OfPair {
      const Contact* felt;
      SIM_FN Contact operator()(int k) const { return felt[k]; }
    };
    struct OfWall {
      const InRoom& here;
      int body, wall;
      SIM_FN Contact operator()(int k) const {
        Contact out = here.feelers_of(body).meets(k, here.m.walls, wall);
        here.look_ahead(out, here.velocity_at(body, out.at));
        return out;
      }
    };
    SIM_FN void pick(int group) const {
      const Partners it = m.partners(group);
      Contact* const out = room.picked + group * most_contacts;
      if (it.second >= 0) {
        if (!room.found[group]) return;
        const int n = 2 * m.feelers;
        room.found[group] = pick_contacts(OfPair{room.felt + group * n}, n, pad(it), out);
      } else {
        const int n = is_free(it.first) ? feelers_of(it.first).corners() : 0;
        room.found[group] = pick_contacts(OfWall{*this, it.first, ~it.second}, n, pad(it), out);
      }
    }
    SIM_FN void list(int) const {
      int n = 0;
      for (int group = 0; group < m.groups(); ++group) {
        for (int k = 0; k < room.found[group]; ++k)
          room.list[n++] = {room.picked[group * most_contacts + k], m.partners(group)};
      }
      *room.listed = n;
      int touch = 0;
      for (int b = 0; b < m.count; ++b) {
        room.touch_begin[b] = touch;
        for (int c = 0; c < n; ++c) {
          if (room.list[c].between.first == b) room.touches[touch++] = 2 * c;
          if (room.list[c].between.second == b) room.touches[touch++] = 2 * c + 1;
        }
      }
      room.touch_begin[m.count] = touch;
    }

    SIM_FN void lay(int c) const {
      const ListedContact& it = room.list[c];
      const int a = it.between.first, b = it.between.second;
      ContactRow* const rows = room.rows + c * m.width();
      rows[0] = row_along(it, it.contact.normal, true);
      rows[0].wanted = -at_least(it.contact.gap, 0.0f) / m.drive.dt;
      rows[0].most = b < 0 ? 3e38f : most_push(fastest());
      if (!m.rough) return;
      const float own = m.friction[a];
      room.friction[c] = b < 0 ? own : sqrtf(own * m.friction[b]);
      Vec3 sliding = velocity_at(a, it.contact.at);
      if (b >= 0) sliding = sliding - velocity_at(b, it.contact.at);
      const Vec3 along = across(it.contact.normal, sliding);
      rows[1] = row_along(it, along, false);
      rows[2] = row_along(it, cross(it.contact.normal, along), false);
    }
    /// A unit vector perpendicular to n, along v's perpendicular part if there is one.
    SIM_FN static Vec3 across(Vec3 n, Vec3 v) {
      Vec3 part = v - dot(n, v) * n;
      if (length(part) < 1e-4f) part = fabsf(n.x) < 0.7f ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0});
      return (1 / length(part)) * part;
    }
    SIM_FN ContactRow row_along(const ListedContact& it, Vec3 way, bool normal) const {
      ContactRow out{};
      out.first = it.between.first;
      out.second = it.between.second;
      out.way = way;
      out.ease = arm(out.first, it.contact.at, way, normal, out.lever, out.turn);
      if (out.second >= 0)
        out.ease += arm(out.second, it.contact.at, way, normal, out.other_lever, out.other_turn);
      return out;
    }
    /// Speed at `at` along `way` per unit push, 1/m_*; sets the lever and the spin change. A normal push on a
    /// sphere gives exactly zero torque.
    SIM_FN float arm(int b, Vec3 at, Vec3 way, bool normal, Vec3& lever, Vec3& turn) const {
      lever = turn = {0, 0, 0};
      if (normal && is_ball(b)) return room.rates[b].ease;
      lever = cross(at - room.start[b].centre, way);
      if (is_free(b)) turn = spin_of(m.free[b], room.start[b].turn, lever);
      return room.rates[b].ease + dot(lever, turn);
    }

    SIM_FN ContactRows rows(bool rub) const {
      return {.rows = room.rows,
              .friction = rub ? room.friction : nullptr,
              .bodies = room.rates,
              .along = room.along,
              .at = room.progress,
              .touches = room.touches,
              .touch_begin = room.touch_begin,
              .body_count = m.count,
              .contacts = *room.listed,
              .width = m.width()};
    }
    template <class Threads>
    SIM_FN void solve(Threads threads) const {
      if (*room.listed > 0) rows(m.rough).solve(threads);
      threads.each(1, Step<&InRoom::take_pushes>{*this});
      threads.each(m.count, Step<&InRoom::rest>{*this});
      if (*room.deep) rows(false).solve(threads);
    }
    SIM_FN void take_pushes(int) const {
      for (int r = 0; r < *room.listed * m.width(); ++r) take_push(room.rows[r]);
      want_apart();
    }
    SIM_FN void take_push(const ContactRow& row) const {
      if (row.push == 0) return;
      const Vec3 push = row.push * row.way;
      move_by(row.first, push, row.push * row.lever);
      if (row.second < 0) {
        m.free[row.first].by_walls += push;
        return;
      }
      move_by(row.second, -1.0f * push, -row.push * row.other_lever);
      m.by_others[row.first] += push;
      m.by_others[row.second] += -1.0f * push;
    }
    SIM_FN void move_by(int b, Vec3 push, Vec3 moment) const {
      if (!is_free(b)) return;
      m.free[b].momentum += push;
      m.free[b].spin += moment;
    }
    /// Prepares the correction of penetration: sets each row's wanted speed. The bodies' rates then describe
    /// only this correction of position; they add no momentum.
    SIM_FN void want_apart() const {
      const float dt = m.drive.dt;
      float most = 0;
      *room.deep = 0;
      for (int c = 0; c < *room.listed; ++c) {
        ContactRow& row = room.rows[c * m.width()];
        const float depth = -room.list[c].contact.gap;
        const float mend = at_most(mended * (depth - slop * m.spacing), fastest_mend * m.spacing);
        if (mend > 0) *room.deep = 1;
        row.wanted = (depth < 0 ? depth : at_least(mend, 0.0f)) / dt - rows(false).speed(row);
        most = at_least(fabsf(row.wanted), most);
      }
      for (int r = 0; r < *room.listed * m.width(); ++r) {
        room.rows[r].push = 0;
        if (room.rows[r].second >= 0) room.rows[r].most = most_push(most);
      }
    }
    SIM_FN void rest(int b) const {
      room.rates[b].velocity = {0, 0, 0};
      room.rates[b].spin = {0, 0, 0};
    }

    SIM_FN void move(int b) const {
      FreeBody& it = m.free[b];
      if (!is_free(b)) return;
      const float dt = m.drive.dt;
      Body& body = m.bodies[b];
      const BodyRate& apart = room.rates[b];
      const Vec3 from = body.centre;
      body.centre = fused(from, dt / it.mass, it.momentum) + dt * apart.velocity;
      turn_on(body, it, dt);
      body.turn = turned_by(body.turn, dt * apart.spin);
      body.spin += apart.spin;
      body.centre += WallContact{m.walls, body, it, dt, mesh_of(m.meshes, b)}.way_back();
      body.velocity = (1 / dt) * (body.centre - from);
    }
  };

  template <class Block>
  SIM_FN void operator()(Block block, unsigned char* room) const {
    const InRoom here{*this, parts_of(room)};
    block.each(count, InRoom::Step<&InRoom::begin>{here});
    block.each(pairs(), InRoom::Step<&InRoom::screen>{here});
    block.each(2 * pairs() * feelers, InRoom::Step<&InRoom::feel>{here});
    block.each(groups(), InRoom::Step<&InRoom::pick>{here});
    block.each(1, InRoom::Step<&InRoom::list>{here});
    block.each(*here.room.listed, InRoom::Step<&InRoom::lay>{here});
    block.by_one_warp(Solve{here});
    block.each(count, InRoom::Step<&InRoom::move>{here});
  }

 private:
  struct Solve {
    const InRoom& here;
    template <class Threads>
    SIM_FN void operator()(Threads threads) const {
      here.solve(threads);
    }
  };
  template <class T>
  SIM_FN static void take(unsigned char* room, std::size_t& bytes, T*& out, std::size_t n) {
    out = room ? reinterpret_cast<T*>(room + bytes) : nullptr;
    bytes += (n * sizeof(T) + 15) / 16 * 16;
  }
};

}  // namespace sim::SIM_BACKEND
