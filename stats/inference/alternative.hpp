#pragma once
/// The side of a test.

namespace stats {

/// Less: the parameter is below its null value. Greater: it is above it.
enum class Alternative { TwoSided, Less, Greater };

}  // namespace stats
