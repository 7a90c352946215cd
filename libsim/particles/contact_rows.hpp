#pragma once
/// The pushes that keep bodies apart, all at once: projected Gauss-Seidel with the conjugate steps of
/// Silcowitz, Niebe and Erleben (2010), A nonsmooth nonlinear conjugate gradient method for interactive
/// contact force problems. A heavy body on a light one takes Gauss-Seidel alone as many sweeps as the ratio
/// of their masses.

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
  float before, step;       ///< of the conjugate steps
};

/// Contacts of `width` rows each: the normal, and with friction two ways to slide.
struct ContactRows {
  ContactRow* rows;
  const float* friction;  ///< coefficient of each contact; nullptr: all slide freely
  BodyRate* bodies;
  int contacts, width;

  static constexpr int most_sweeps = 32;
  static constexpr float still = 1e-5f;  ///< changes of speed that end the sweeps, m/s

  SIM_FN float speed(const ContactRow& row) const {
    const BodyRate& a = bodies[row.first];
    float out = dot(row.way, a.velocity) + dot(row.lever, a.spin);
    if (row.second < 0) return out;
    const BodyRate& b = bodies[row.second];
    return out - dot(row.way, b.velocity) - dot(row.other_lever, b.spin);
  }
  SIM_FN void give(const ContactRow& row, float push) const {
    BodyRate& a = bodies[row.first];
    a.velocity += (push * a.ease) * row.way;
    a.spin += push * row.turn;
    if (row.second < 0) return;
    BodyRate& b = bodies[row.second];
    b.velocity += (-push * b.ease) * row.way;
    b.spin += -push * row.other_turn;
  }

  /// One thread's work. The bodies' rates are then those that the rows' pushes give. Returns the sweeps.
  SIM_FN int solve() const {
    float last = 0;
    for (int sweep = 1; sweep <= most_sweeps; ++sweep) {
      each_contact();
      float changed = 0, most = 0;
      for (int r = 0; r < contacts * width; ++r) {
        const float change = (rows[r].push - rows[r].before) * rows[r].ease;
        most = at_least(fabsf(change), most);
        changed += change * (rows[r].push - rows[r].before);
      }
      // A sweep has the last word: it alone keeps pushes from pulling, and friction within its cone.
      if (most <= still || sweep == most_sweeps) return sweep;
      const float share = sweep > 1 ? changed / last : 0;
      last = changed;
      step_on(share <= 1 ? share : 0, share <= 1);
    }
    return most_sweeps;
  }

 private:
  SIM_FN void each_contact() const {
    for (int c = 0; c < contacts; ++c) {
      ContactRow* const row = rows + c * width;
      for (int k = 0; k < width; ++k) row[k].before = row[k].push;
      change(row[0], at_least(row[0].push + missing(row[0]), 0.0f));
      if (friction && friction[c] > 0) rub(row + 1, friction[c] * row[0].push);
    }
  }
  /// The push that would give a row what it wants.
  SIM_FN float missing(const ContactRow& row) const { return (row.wanted - speed(row)) / row.ease; }
  SIM_FN void change(ContactRow& row, float push) const {
    give(row, push - row.push);
    row.push = push;
  }
  /// Coulomb's law: what slides is braked by `most`, what sticks by as much as holds it.
  SIM_FN void rub(ContactRow* row, float most) const {
    const float u = row[0].push + missing(row[0]);
    const float v = row[1].push + missing(row[1]);
    const float whole = sqrtf(u * u + v * v);
    const float share = whole > most ? most / whole : 1.0f;
    change(row[0], share * u);
    change(row[1], share * v);
  }
  SIM_FN void step_on(float share, bool keeps) const {
    for (int r = 0; r < contacts * width; ++r) {
      ContactRow& row = rows[r];
      const float beyond = share * row.step;
      row.step = keeps ? beyond + (row.push - row.before) : 0.0f;
      if (beyond == 0) continue;
      give(row, beyond);
      row.push += beyond;
    }
  }
};

}  // namespace sim::SIM_BACKEND
