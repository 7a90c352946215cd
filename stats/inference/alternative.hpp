#pragma once
/// The side of a test.

namespace stats {

/// Less: the parameter lies below its value under the null. Greater: above it.
enum class Alternative { TwoSided, Less, Greater };

}  // namespace stats
