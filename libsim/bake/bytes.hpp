#pragma once
/// Writes and reads little-endian values in byte buffers. A read beyond the end of a buffer is an error.

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "stats/base/error.hpp"

namespace sim {

static_assert(std::endian::native == std::endian::little, "bake files are read and written little-endian");

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

/// Appends values to the caller's buffer.
class ByteWriter {
 public:
  explicit ByteWriter(Bytes& out) : out_(out) {}

  template <typename T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes({reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  }
  void bytes(ByteSpan data) { out_.insert(out_.end(), data.begin(), data.end()); }
  /// Writes the text's length in 32 bits, then its characters.
  void string(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

 private:
  Bytes& out_;
};

/// Reads values from the front of a span. If too few bytes are left: base::Error that names `place`.
class ByteReader {
 public:
  ByteReader(ByteSpan data, std::string place) : data_(data), place_(std::move(place)) {}

  template <typename T>
  T get() {
    static_assert(std::is_arithmetic_v<T>);
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  ByteSpan take(std::size_t size) {
    if (size > data_.size()) fail("ends early");
    const ByteSpan front = data_.first(size);
    data_ = data_.subspan(size);
    return front;
  }
  std::string string(std::size_t max_size) {
    const auto size = get<std::uint32_t>();
    if (size > max_size)
      fail("has a text of " + std::to_string(size) + " characters; at most " + std::to_string(max_size) +
           " are allowed");
    const ByteSpan text = take(size);
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  ByteSpan rest() const { return data_; }

  [[noreturn]] void fail(const std::string& problem) const {
    throw base::Error(place_, problem,
                      "if the file was read, it is damaged: make it again; if it was being written, change "
                      "the scene or the options that give this value");
  }

 private:
  ByteSpan data_;
  std::string place_;
};

}  // namespace sim
