#include "libsim/render/pass_timer.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

#include "libsim/gl/gl_context.hpp"

namespace sim {

PassTimer::PassTimer(bool on) : on_(on), software_(on && gl_is_software()) {}

PassTimer::~PassTimer() {
  if (!queries_.empty()) glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

void PassTimer::start() {
  if (!on_) return;
  passes_.clear();
  seconds_.clear();
  stamps_ = 0;
  stamp();
}

void PassTimer::mark(const char* pass) {
  if (!on_) return;
  passes_.emplace_back(pass);
  stamp();
}

void PassTimer::stamp() {
  if (software_) {
    glFinish();
    seconds_.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count());
  } else {
    if (stamps_ == queries_.size()) {
      queries_.push_back(0);
      glCreateQueries(GL_TIMESTAMP, 1, &queries_.back());
    }
    glQueryCounter(queries_[stamps_], GL_TIMESTAMP);
  }
  ++stamps_;
}

std::vector<PassTime> PassTimer::times() const {
  std::vector<PassTime> times;
  std::vector<double> seconds = seconds_;
  for (std::size_t i = 0; !software_ && i < stamps_; ++i) {
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(queries_[i], GL_QUERY_RESULT, &nanoseconds);
    seconds.push_back(static_cast<double>(nanoseconds) * 1e-9);
  }
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    const double ms = (seconds[i + 1] - seconds[i]) * 1e3;
    const auto known =
        std::find_if(times.begin(), times.end(), [&](const PassTime& t) { return t.pass == passes_[i]; });
    if (known == times.end()) {
      times.push_back({passes_[i], ms});
    } else {
      known->ms += ms;
    }
  }
  return times;
}

}  // namespace sim
