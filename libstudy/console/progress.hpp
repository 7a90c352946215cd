#pragma once
/// Estimates the remaining duration of a session.

#include <span>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Expected duration of a unit, s. A trial takes the times of its steps, 1.5 s for the word and the black
/// screen before each stimulus of a pair, and 5 s for each question. A page takes the time of its block or of
/// reading its text (3.5 words per second), whichever is longer; each question on it adds reading its text,
/// and 5 s for listed answers, 10 s for a number, 30 s for text, 2 s for a reaction. A pause takes its
/// planned time. person: false for a simulated participant, who reads and answers at once. showing_s:
/// duration of one showing for each cell of the design, s; empty: as planned.
double expected_s(const Protocol& protocol, const OpenUnit& unit, bool person = true,
                  std::span<const double> showing_s = {});
double expected_s(const Protocol& protocol, std::span<const OpenUnit> units, bool person = true,
                  std::span<const double> showing_s = {});

/// Estimate of the bytes that the units add to a database: 64 bytes per frame and 4 KiB per unit. A stimulus
/// without a schedule counts as 60 frames/s.
std::uint64_t expected_bytes(const Protocol& protocol, std::span<const OpenUnit> units);

}  // namespace study
