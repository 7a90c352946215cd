#pragma once
/// Writes and reads state that lasts beyond a frame. A class lists its state once, in keep(archive), so that
/// writing and reading cannot diverge.

#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "libsim/particles/particles.hpp"
#include "stats/base/error.hpp"

namespace sim::SIM_BACKEND {

class StateWriter {
 public:
  static constexpr bool reads = false;

  template <class... T>
  void operator()(T&... values) {
    (put(values), ...);
  }
  const std::string& bytes() const { return out_; }

 private:
  template <class T>
  void put(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      raw(&value, sizeof value);
    } else {
      value.keep(*this);
    }
  }
  template <class T>
  void put(std::vector<T>& values) {
    count(values.size());
    raw(values.data(), values.size() * sizeof(T));
  }
  template <class T>
  void put(Array<T>& values) {
    auto host = values.to_host();
    put(host);
  }
  template <class T>
  void put(std::optional<T>& value) {
    bool there = value.has_value();
    put(there);
    if (there) put(*value);
  }
  void count(std::uint64_t value) { put(value); }
  void raw(const void* from, std::size_t size) {
    if (size > 0) out_.append(static_cast<const char*>(from), size);
  }

  std::string out_;
};

/// Reads bytes whose checksum was verified. base::Error if the bytes still do not fit the state.
class StateReader {
 public:
  static constexpr bool reads = true;

  explicit StateReader(std::string_view bytes) : left_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  void finish() const {
    if (!left_.empty()) fail("contains more data than the state of this run");
  }
  [[noreturn]] static void fail(const std::string& problem) {
    throw base::Error("saved state", problem,
                      "resume with the program, the scene and the options with which it was saved");
  }

 private:
  template <class T>
  void get(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      std::memcpy(&value, take(sizeof value), sizeof value);
    } else {
      value.keep(*this);
    }
  }
  template <class T>
  void get(std::vector<T>& values) {
    std::uint64_t count = 0;
    get(count);
    if (count > left_.size() / sizeof(T)) fail("ends early");
    values.resize(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(values.data(), take(values.size() * sizeof(T)), values.size() * sizeof(T));
  }
  template <class T>
  void get(Array<T>& values) {
    std::vector<T> host;
    get(host);
    values.from_host(host);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  const char* take(std::size_t size) {
    if (size > left_.size()) fail("ends early");
    const char* out = left_.data();
    left_.remove_prefix(size);
    return out;
  }

  std::string_view left_;
};

/// Writes or reads the allocated columns, with one value per particle.
template <class Archive>
void keep_columns(Archive& archive, Particles& particles) {
  auto& columns = particles.all();
  const auto n = static_cast<std::size_t>(particles.size());
#define SIM_KEEP(Name, member, ...)                                                         \
  if (particles.has(Column::Name)) {                                                        \
    archive(columns.member);                                                                \
    if constexpr (Archive::reads) {                                                         \
      if (columns.member.size() != n) Archive::fail("contains a column of a wrong length"); \
    }                                                                                       \
  }
#define SIM_NOTHING(...)
  SIM_COLUMNS(SIM_KEEP, SIM_NOTHING)
#undef SIM_KEEP
#undef SIM_NOTHING
}

}  // namespace sim::SIM_BACKEND
