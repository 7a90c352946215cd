#pragma once
/// "kind:key=number,key=number": the specification of a simulated observer on the command line and in the
/// record.

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace study {

/// A parameter of an observer's model.
struct ObserverKey {
  std::string_view name;
  double* value;  ///< in: the default; out: the value read
  double min, max;
  bool open_min = false;  ///< the minimum itself is out of range
  bool required = false;
};

/// base::Error "observer 'SPECIFICATION', character N": `problem`, with the remedy `mend`.
[[noreturn]] void fail_observer(std::string_view specification, std::size_t at, const std::string& problem,
                                const std::string& mend);

/// Reads "key=number,..." from character `at` on. Names the place of a key that is unknown, repeated or
/// missing, of a bad number and of one out of range.
void read_observer_keys(std::string_view specification, std::size_t at, std::span<const ObserverKey> keys,
                        const std::string& mend);

/// One number without a key, such as "4" in "constant:4".
double read_observer_number(std::string_view specification, std::size_t at, std::string_view text, double min,
                            double max, const std::string& mend);

/// The keys that are recorded. The last one is omitted if it is 0, so that records from before that key
/// existed stay equal.
template <std::size_t count>
std::span<const ObserverKey> written(const std::array<ObserverKey, count>& keys) {
  return std::span<const ObserverKey>(keys).first(*keys.back().value == 0 ? count - 1 : count);
}

/// "a=31,b=0.035": every key with the shortest text of its value that reads back exactly.
std::string write_observer_keys(std::span<const ObserverKey> keys);
std::string shortest_number(double value);

}  // namespace study
