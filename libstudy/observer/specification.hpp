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
  double* value;  ///< before reading: the default; afterwards: the given value, if there is one
  double min, max;
  bool open_min = false;  ///< true: the minimum itself is out of range
  bool required = false;
};

/// Throws a base::Error with the place "observer 'SPECIFICATION', character N", where N = at + 1.
[[noreturn]] void fail_observer(std::string_view specification, std::size_t at, const std::string& problem,
                                const std::string& mend);

/// Reads "key=number,..." from character `at` on. base::Error for a key that is unknown, repeated or missing,
/// and for a number that is wrong or out of range.
void read_observer_keys(std::string_view specification, std::size_t at, std::span<const ObserverKey> keys,
                        const std::string& mend);

/// Reads one number without a key, such as "4" in "constant:4". base::Error if it is no number from min to
/// max.
double read_observer_number(std::string_view specification, std::size_t at, std::string_view text, double min,
                            double max, const std::string& mend);

/// The keys to write to the record. Omits the last key (effects) if its value is 0: records of earlier
/// versions lack this key, and equal observers must have equal records.
template <std::size_t count>
std::span<const ObserverKey> written(const std::array<ObserverKey, count>& keys) {
  return std::span<const ObserverKey>(keys).first(*keys.back().value == 0 ? count - 1 : count);
}

/// Text such as "a=31,b=0.035": every key with the shortest text from which its value is read back exactly.
std::string write_observer_keys(std::span<const ObserverKey> keys);
std::string shortest_number(double value);

}  // namespace study
