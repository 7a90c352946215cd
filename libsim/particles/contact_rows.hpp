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
  // Of conjugate gradients: speed that is missing, direction of pushes, speed that it gives.
  float left, step, along;
};

/// What one thread tells the others. It is read before the next wait, and written after it.
struct ContactProgress {
  float swept;  ///< the most that a sweep changed a speed, m/s
};

/// Contacts of `width` rows each: the normal, and with friction two ways to slide. Each step waits for the
/// one before; sweeps are one thread's, and sums have one order.
struct ContactRows {
  ContactRow* rows;
  const float* friction;  ///< coefficient of each contact; nullptr: all slide freely
  BodyRate* bodies;
  BodyRate* along;  ///< as many: what the direction does to them
  ContactProgress* at;
  const int* touches;      ///< by body: twice the contact's number, and 1 more for the second of its bodies
  const int* touch_begin;  ///< of each body, and the end
  int body_count;
  int contacts, width;

  static constexpr int most_rounds = 8, last_rounds = 4, most_steps = 32;
  static constexpr float still = 1e-5f;  ///< changes of speed that end them, m/s

  SIM_FN float speed(const ContactRow& row) const { return speed(row, bodies); }

  /// The bodies' rates are then those that the rows' pushes give. Where friction does not settle, it stays as
  /// it came to be, and the rest does.
  template <class Threads>
  SIM_FN void solve(Threads threads) const {
    if (settles(threads, most_rounds) || !friction) return;
    threads.each(0, Step<&ContactRows::sweep>{*this});  // all have read what the last sweep told
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
      // A sweep has the last word: it keeps pushes from pulling, and friction within its cone.
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
  /// The push that would give a row what it wants.
  SIM_FN float missing(const ContactRow& row) const { return (row.wanted - speed(row)) / row.ease; }
  SIM_FN void change(ContactRow& row, float push, float& most) const {
    most = at_least(fabsf(push - row.push) * row.ease, most);
    give(row, push - row.push);
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

  /// Conjugate gradients over the open rows. One that comes to its bound is shut, and the rest begin anew.
  /// All threads know the same sums, and so go the same way.
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
      // In directions that move nobody there is nothing left to gain.
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
  /// What is missing says what a step along it gains.
  struct Worth {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const {
      return rows[r].open ? rows[r].left * rows[r].left / rows[r].ease : 0.0f;
    }
  };
  /// Less than 0 by what an open row misses, m/s.
  struct Missed {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const { return rows[r].open ? -fabsf(rows[r].left) : 0.0f; }
  };
  /// What a way of 1 along the direction changes of that gain.
  struct Steep {
    const ContactRow* rows;
    SIM_FN float operator()(int r) const { return rows[r].step * rows[r].along; }
  };
  /// The next direction: what is missing, and of the last direction the share that keeps them conjugate.
  struct Aim {
    ContactRow* rows;
    float share;
    SIM_FN void operator()(int r) const {
      ContactRow& row = rows[r];
      row.step = row.open ? row.left / row.ease + share * row.step : 0.0f;
    }
  };
  /// The way along the direction at which a row comes to its bound.
  struct ToBound {
    const ContactRows& here;
    SIM_FN float operator()(int r) const {
      const ContactRow& row = here.rows[r];
      if (row.step == 0) return 3e38f;
      return at_least((here.bound_of(r, row.step < 0) - row.push) / row.step, 0.0f);
    }
  };
  /// Along the direction, to its lowest place or to the first bound.
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
  /// Of a row's pushes: a normal never pulls, and friction follows the pushes that the sweep left.
  SIM_FN float bound_of(int r, bool low) const {
    if (!low) return rows[r].most;
    return r % width == 0 ? 0.0f : -rows[r].most;
  }
};

}  // namespace sim::SIM_BACKEND
