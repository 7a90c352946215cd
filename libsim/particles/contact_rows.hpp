#pragma once
/// The pushes that keep bodies apart, all at once: sweeps of projected Gauss-Seidel find who pushes, and
/// conjugate gradients how much (Silcowitz, Niebe and Erleben 2010, Projected Gauss-Seidel subspace
/// minimization). Sweeps alone take a heavy body on a light one as often as the ratio of their masses.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// How a body moves while its contacts are solved.
struct BodyRate {
  Vec3 velocity;  ///< of the centre, m/s
  Vec3 spin;      ///< rad/s
  float ease;     ///< 1 / mass, 1/m_*; 0: nothing moves it
};

/// One direction of a contact, along which two bodies push each other.
struct ContactRow {
  int first, second;        ///< bodies; second < 0: a wall
  Vec3 way;                 ///< unit vector, towards the first
  Vec3 lever, other_lever;  ///< arm x way of the first and the second
  Vec3 turn, other_turn;    ///< what a push of 1 does to their spins
  float ease;               ///< speed of parting that a push of 1 gives, 1/m_*
  float wanted;             ///< least speed of parting; of friction the speed of sliding, 0
  float push;               ///< so far, m_* m/s
  bool open;                ///< neither at rest nor at its bound
  float most;               ///< that bound, m_* m/s; of friction it follows from the normal's push
  float left, step;         ///< of conjugate gradients: speed that is missing, direction of pushes
};

/// Contacts of `width` rows each: the normal, and with friction two ways to slide.
struct ContactRows {
  ContactRow* rows;
  const float* friction;  ///< coefficient of each contact; nullptr: all slide freely
  BodyRate* bodies;
  BodyRate* along;  ///< as many: scratch memory
  int body_count;
  int contacts, width;

  static constexpr int most_rounds = 24, most_steps = 32;
  static constexpr float still = 1e-5f;  ///< changes of speed that end them, m/s

  SIM_FN float speed(const ContactRow& row) const { return speed(row, bodies); }

  /// One thread's work. The bodies' rates are then those that the rows' pushes give. Returns the rounds.
  SIM_FN int solve() const {
    for (int round = 1; round < most_rounds; ++round) {
      // A sweep has the last word: it keeps pushes from pulling, and friction within its cone.
      if (sweep() <= still) return round;
      descend();
    }
    sweep();
    return most_rounds;
  }

 private:
  SIM_FN static float speed(const ContactRow& row, const BodyRate* rates) {
    const BodyRate& a = rates[row.first];
    const float out = dot(row.way, a.velocity) + dot(row.lever, a.spin);
    if (row.second < 0) return out;
    const BodyRate& b = rates[row.second];
    return out - dot(row.way, b.velocity) - dot(row.other_lever, b.spin);
  }
  SIM_FN void give(const ContactRow& row, float push, BodyRate* rates) const {
    BodyRate& a = rates[row.first];
    a.velocity += (push * bodies[row.first].ease) * row.way;
    a.spin += push * row.turn;
    if (row.second < 0) return;
    BodyRate& b = rates[row.second];
    b.velocity += (-push * bodies[row.second].ease) * row.way;
    b.spin += -push * row.other_turn;
  }
  SIM_FN int row_count() const { return contacts * width; }
  SIM_FN bool rubs(int contact) const { return friction && friction[contact] > 0; }

  /// Returns the largest change of speed.
  SIM_FN float sweep() const {
    float most = 0;
    for (int c = 0; c < contacts; ++c) {
      ContactRow* const row = rows + c * width;
      change(row[0], at_most(at_least(row[0].push + missing(row[0]), 0.0f), row[0].most), most);
      if (rubs(c)) rub(row + 1, friction[c] * row[0].push, most);
    }
    return most;
  }
  /// The push that would give a row what it wants.
  SIM_FN float missing(const ContactRow& row) const { return (row.wanted - speed(row)) / row.ease; }
  SIM_FN void change(ContactRow& row, float push, float& most) const {
    most = at_least(fabsf(push - row.push) * row.ease, most);
    give(row, push - row.push, bodies);
    row.push = push;
  }
  /// Coulomb's law: what slides is braked by `bound`, what sticks by as much as holds it.
  SIM_FN void rub(ContactRow* row, float bound, float& most) const {
    const float u = row[0].push + missing(row[0]);
    const float v = row[1].push + missing(row[1]);
    const float whole = sqrtf(u * u + v * v);
    const float share = whole > bound ? bound / whole : 1.0f;
    change(row[0], share * u, most);
    change(row[1], share * v, most);
    row[0].open = row[1].open = whole < bound;
    row[0].most = row[1].most = bound;
  }

  /// Conjugate gradients over the open rows. One that would pull is shut, and the rest begin anew.
  SIM_FN void descend() const {
    for (int r = 0; r < row_count(); ++r) {
      ContactRow& row = rows[r];
      if (r % width == 0) row.open = row.push > 0 && row.push < row.most;
      if (r % width != 0 && !rubs(r / width)) row.open = false;
      row.left = row.wanted - speed(row);
    }
    float worth = turn_to(0);
    for (int k = 0; k < most_steps && worth > 0; ++k) {
      const float steep = look_along();
      // In directions that move nobody there is nothing left to gain.
      if (!(steep > 1e-6f * worth)) return;
      int shut = -1;
      if (go(way_to_bound(worth / steep, shut)) <= 0.3f * still) return;
      if (shut >= 0) {
        rows[shut].push = bound_of(shut, rows[shut].step < 0);
        rows[shut].open = false;
      }
      worth = turn_to(shut < 0 ? 1 / worth : 0);
    }
  }
  /// The next direction: what is missing, and of the last direction the share that keeps them conjugate.
  /// Returns its worth.
  SIM_FN float turn_to(float per_last) const {
    float worth = 0;
    for (int r = 0; r < row_count(); ++r) {
      if (rows[r].open) worth += rows[r].left * rows[r].left / rows[r].ease;
    }
    for (int r = 0; r < row_count(); ++r) {
      ContactRow& row = rows[r];
      if (!row.open) continue;
      row.step = row.left / row.ease + (per_last > 0 ? worth * per_last * row.step : 0.0f);
    }
    return worth;
  }
  /// What the direction does to the bodies, and how steep the energy is curved along it.
  SIM_FN float look_along() const {
    for (int b = 0; b < body_count; ++b) along[b] = {{0, 0, 0}, {0, 0, 0}, 0};
    for (int r = 0; r < row_count(); ++r) {
      if (rows[r].open) give(rows[r], rows[r].step, along);
    }
    float steep = 0;
    for (int r = 0; r < row_count(); ++r) {
      if (rows[r].open) steep += rows[r].step * speed(rows[r], along);
    }
    return steep;
  }
  SIM_FN float way_to_bound(float way, int& shut) const {
    for (int r = 0; r < row_count(); ++r) {
      const ContactRow& row = rows[r];
      if (!row.open || row.step == 0) continue;
      const float bound = bound_of(r, row.step < 0);
      if (row.step < 0 ? row.push + way * row.step >= bound : row.push + way * row.step <= bound) continue;
      way = at_least((bound - row.push) / row.step, 0.0f);
      shut = r;
    }
    return way;
  }
  /// Of a row's pushes: a normal never pulls, and friction follows the pushes that the sweep left.
  SIM_FN float bound_of(int r, bool low) const {
    if (!low) return rows[r].most;
    return r % width == 0 ? 0.0f : -rows[r].most;
  }
  /// Returns the most that a row then misses, m/s.
  SIM_FN float go(float way) const {
    float most = 0;
    for (int r = 0; r < row_count(); ++r) {
      ContactRow& row = rows[r];
      if (!row.open) continue;
      row.push += way * row.step;
      row.left -= way * speed(row, along);
      most = at_least(fabsf(row.left), most);
    }
    for (int b = 0; b < body_count; ++b) {
      bodies[b].velocity += way * along[b].velocity;
      bodies[b].spin += way * along[b].spin;
    }
    return most;
  }
};

}  // namespace sim::SIM_BACKEND
