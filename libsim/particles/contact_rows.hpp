#pragma once
/// Computes the pushes (contact impulses) that keep bodies apart, for all contacts together: sweeps of
/// projected Gauss-Seidel find the active contacts, and conjugate gradients their magnitudes (Silcowitz,
/// Niebe and Erleben 2010, Projected Gauss-Seidel subspace minimization). With sweeps alone, a heavy body on
/// a light one needs about as many sweeps as the ratio of their masses.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Velocities of a body while its contacts are solved.
struct BodyRate {
  Vec3 velocity;  ///< of the centre, m/s
  Vec3 spin;      ///< rad/s
  float ease;     ///< 1 / mass, 1/m_*; 0: immovable
};

/// One equation of a contact: a direction along which its two bodies push each other. m_* is the mass of a
/// particle of level 0.
struct ContactRow {
  int first, second;        ///< indices of the bodies; second < 0: a wall
  Vec3 way;                 ///< unit vector, towards the first body
  Vec3 lever, other_lever;  ///< cross product arm x way for the first and the second body
  Vec3 turn, other_turn;    ///< change of the bodies' spins per unit push
  float ease;               ///< separation speed per unit push, 1/m_*
  float wanted;             ///< minimum separation speed, m/s; for friction the wanted sliding speed, 0
  float push;               ///< current push, m_* m/s
  bool open;                ///< true if the push lies strictly between its bounds
  float most;  ///< upper bound of the push, m_* m/s; for friction: coefficient times the normal's push
  // For conjugate gradients: missing speed (residual), search direction, speed change per step along it.
  float left, step, along;
};

/// Data that one thread writes, and all threads read after the next barrier. One more barrier comes before
/// the next write.
struct ContactProgress {
  float swept;  ///< largest change of a speed in a sweep, m/s
};

/// All contacts of the bodies. Each contact has `width` rows: the normal, and with friction two sliding
/// directions. Steps run one after another; one thread runs the sweeps, and sums have a fixed order.
struct ContactRows {
  ContactRow* rows;
  const float* friction;  ///< coefficient of each contact; nullptr: no friction
  BodyRate* bodies;
  BodyRate* along;  ///< per body: its velocity change per step along the search direction
  ContactProgress* at;
  /// the contacts of body 0, then of body 1, ...: twice the contact's index, plus 1 if the body is the
  /// contact's second
  const int* touches;
  const int* touch_begin;  ///< index of each body's first entry in touches, then the number of all entries
  int body_count;
  int contacts, width;

  static constexpr int most_rounds = 8, last_rounds = 4, most_steps = 32;
  /// the solution has converged if a sweep changes every speed by at most this, m/s
  static constexpr float still = 1e-5f;

  SIM_FN float speed(const ContactRow& row) const { return speed(row, bodies); }

  /// Computes all pushes and adds them to the bodies' velocities. If friction does not converge, its pushes
  /// stay fixed, and the normals are solved again.
  template <class Threads>
  SIM_FN void solve(Threads threads) const {
    if (settles(threads, most_rounds) || !friction) return;
    // A barrier: after it, all threads have read the last sweep's result.
    threads.each(0, Step<&ContactRows::sweep>{*this});
    ContactRows normals = *this;
    normals.friction = nullptr;
    normals.settles(threads, last_rounds);
  }

 private:
  template <void (ContactRows::*step)(int) const>
  struct Step {
    const ContactRows& here;
    SIM_FN void operator()(int i) const { (here.*step)(i); }
  };

  template <class Threads>
  SIM_FN bool settles(Threads threads, int rounds) const {
    for (int round = 1; round <= rounds; ++round) {
      // The last step is always a sweep: it makes normal pushes >= 0 and limits friction to its cone.
      threads.each(1, Step<&ContactRows::sweep>{*this});
      if (at->swept <= still) return true;
      if (round < rounds) descend(threads);
    }
    return false;
  }

  SIM_FN static float speed(const ContactRow& row, const BodyRate* rates) {
    const BodyRate& a = rates[row.first];
    const float out = dot(row.way, a.velocity) + dot(row.lever, a.spin);
    if (row.second < 0) return out;
    const BodyRate& b = rates[row.second];
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
  SIM_FN int row_count() const { return contacts * width; }
  SIM_FN bool rubs(int contact) const { return friction && friction[contact] > 0; }

  SIM_FN void sweep(int) const {
    float most = 0;
    for (int c = 0; c < contacts; ++c) {
      ContactRow* const row = rows + c * width;
      change(row[0], at_most(at_least(row[0].push + missing(row[0]), 0.0f), row[0].most), most);
      if (rubs(c)) rub(row + 1, friction[c] * row[0].push, most);
    }
    at->swept = most;
  }
  /// The change of a row's push that gives the row its wanted speed.
  SIM_FN float missing(const ContactRow& row) const { return (row.wanted - speed(row)) / row.ease; }
  SIM_FN void change(ContactRow& row, float push, float& most) const {
    most = at_least(fabsf(push - row.push) * row.ease, most);
    give(row, push - row.push);
    row.push = push;
  }
  /// Coulomb's law for the two friction rows of a contact: a sliding contact gets a push of size `bound`, a
  /// sticking contact the smaller push that stops its sliding.
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

  /// Conjugate gradients over the open rows. A row that reaches its bound is closed, and the method restarts.
  /// All threads get the same sums, and so take the same branches.
  template <class Threads>
  SIM_FN void descend(Threads threads) const {
    const int n = row_count();
    threads.each(n, Step<&ContactRows::open>{*this});
    float worth = threads.sum(n, Worth{rows});
    float share = 0;
    for (int k = 0; k < most_steps && worth > 0; ++k) {
      threads.each(n, Aim{rows, share});
      threads.each(body_count, Step<&ContactRows::look_along>{*this});
      threads.each(n, Step<&ContactRows::look>{*this});
      const float steep = threads.sum(n, Steep{rows});
      // If the pushes along this direction hardly change any speed, further steps gain nothing.
      if (!(steep > 1e-6f * worth)) return;
      int shut, any;
      const float way = threads.least(n, worth / steep, shut, ToBound{*this});
      threads.each(n, Go{*this, way, shut});
      threads.each(body_count, GoBody{*this, way});
      const float missed = -threads.least(n, 0, any, Missed{rows});
      if (missed <= 0.3f * still) return;
      const float next = threads.sum(n, Worth{rows});
      share = shut == n ? next / worth : 0.0f;
      worth = next;
    }
  }
  /// Squared residual (missing separation speed, m/s) of an open row, divided by the row's speed per unit
  /// push; 0 for closed rows.
  struct Worth {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const {
      return rows[r].open ? rows[r].left * rows[r].left / rows[r].ease : 0.0f;
    }
  };
  /// Minus the magnitude of an open row's missing speed, m/s; 0 for closed rows.
  struct Missed {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const { return rows[r].open ? -fabsf(rows[r].left) : 0.0f; }
  };
  /// A row's part of the curvature along the search direction.
  struct Steep {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const { return rows[r].step * rows[r].along; }
  };
  /// Sets the next search direction: residual / ease, plus `share` of the last direction, so that both are
  /// conjugate.
  struct Aim {
    ContactRow* rows;
    float share;
    SIM_FN void operator()(int r) const {
      ContactRow& row = rows[r];
      row.step = row.open ? row.left / row.ease + share * row.step : 0.0f;
    }
  };
  /// Step length along the search direction at which a row reaches its bound.
  struct ToBound {
    const ContactRows& here;
    SIM_FN float operator()(int r) const {
      const ContactRow& row = here.rows[r];
      if (row.step == 0) return 3e38f;
      return at_least((here.bound_of(r, row.step < 0) - row.push) / row.step, 0.0f);
    }
  };
  /// Moves the pushes by `way` along the search direction; the row `shut` is set to its bound and closed.
  struct Go {
    const ContactRows& here;
    float way;
    int shut;
    SIM_FN void operator()(int r) const {
      ContactRow& row = here.rows[r];
      if (!row.open) return;
      row.push += way * row.step;
      row.left -= way * row.along;
      if (r != shut) return;
      row.push = here.bound_of(r, row.step < 0);
      row.open = false;
    }
  };
  struct GoBody {
    const ContactRows& here;
    float way;
    SIM_FN void operator()(int b) const {
      here.bodies[b].velocity += way * here.along[b].velocity;
      here.bodies[b].spin += way * here.along[b].spin;
    }
  };
  SIM_FN void open(int r) const {
    ContactRow& row = rows[r];
    if (r % width == 0) row.open = row.push > 0 && row.push < row.most;
    if (r % width != 0 && !rubs(r / width)) row.open = false;
    row.left = row.wanted - speed(row);
    row.step = 0;
  }
  SIM_FN void look_along(int b) const {
    BodyRate out{{0, 0, 0}, {0, 0, 0}, 0};
    for (int k = touch_begin[b]; k < touch_begin[b + 1]; ++k) {
      const ContactRow* const row = rows + touches[k] / 2 * width;
      const bool second = touches[k] % 2;
      for (int w = 0; w < width; ++w) {
        const float push = second ? -row[w].step : row[w].step;
        out.velocity += (push * bodies[b].ease) * row[w].way;
        out.spin += push * (second ? row[w].other_turn : row[w].turn);
      }
    }
    along[b] = out;
  }
  SIM_FN void look(int r) const { rows[r].along = speed(rows[r], along); }
  /// Lower (`low`) or upper bound of a row's push. The lower bound is 0 for a normal, which never pulls, and
  /// minus the upper bound for friction.
  SIM_FN float bound_of(int r, bool low) const {
    if (!low) return rows[r].most;
    return r % width == 0 ? 0.0f : -rows[r].most;
  }
};

}  // namespace sim::SIM_BACKEND
