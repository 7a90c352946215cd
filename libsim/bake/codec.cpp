#include "libsim/bake/codec.hpp"

#include <zstd.h>

#include <cmath>
#include <memory>
#include <string>

namespace sim {

namespace {

/// Bits of the byte after the particle counts: which facts of the frame follow in the file.
enum FactBits : std::uint8_t { has_temporal = 1, has_tau = 2, has_rate = 4, has_guards = 8, all_bits = 15 };

/// Calls visit for every guard counter (how often a safety rule of the solver intervened), in the order of
/// the file.
template <typename Guards, typename Visit>
void each_guard(Guards& guards, Visit visit) {
  visit(guards.speed_limited);
  visit(guards.coincident_pairs);
  visit(guards.not_finite);
  visit(guards.neighbours_dropped);
  visit(guards.wall_projected);
  visit(guards.nozzle_waited);
  visit(guards.saliency_not_finite);
  visit(guards.gaze_lost);
}

double finite(ByteReader& in, const char* name) {
  const auto value = in.get<double>();
  if (!std::isfinite(value))
    in.fail(std::string("states ") + name + " = " + std::to_string(value) + ", which is not finite");
  return value;
}

TemporalReport get_temporal(ByteReader& in, std::uint8_t bits, std::int64_t particles) {
  TemporalReport out;
  if (bits & has_tau) out.tau = finite(in, "the tolerance tau");
  if (bits & has_rate) {
    const double mean = finite(in, "the mean frame rate");
    out.rate = FrameRate{mean, finite(in, "the standard deviation of the frame rate")};
  }
  out.beta = finite(in, "the probability beta");
  out.active = in.get<std::int64_t>();
  if (out.beta < 0 || out.beta > 1)
    in.fail("states the probability beta = " + std::to_string(out.beta) + ", outside 0 to 1");
  if (out.active < 0 || out.active > particles)
    in.fail("states that " + std::to_string(out.active) + " of its " + std::to_string(particles) +
            " particles were solved");
  return out;
}

}  // namespace

void put_facts(ByteWriter& out, const BakeFacts& facts) {
  const auto& [counts, temporal, guards] = facts.account;
  out.put(facts.time_s);
  for (const std::int64_t count : counts) out.put(count);
  unsigned bits = guards ? has_guards : 0;
  if (temporal) bits |= has_temporal | (temporal->tau ? has_tau : 0) | (temporal->rate ? has_rate : 0);
  out.put(static_cast<std::uint8_t>(bits));
  if (temporal) {
    if (temporal->tau) out.put(*temporal->tau);
    if (temporal->rate) {
      out.put(temporal->rate->mean);
      out.put(temporal->rate->sd);
    }
    out.put(temporal->beta);
    out.put(temporal->active);
  }
  if (guards) each_guard(*guards, [&](std::uint64_t count) { out.put(count); });
}

BakeFacts get_facts(ByteReader& in, std::uint32_t format, std::size_t levels) {
  BakeFacts facts;
  facts.time_s = in.get<double>();
  if (!std::isfinite(facts.time_s)) in.fail("holds a time that is not finite");
  FrameAccount& account = facts.account;
  for (std::size_t i = 0; i < levels; ++i) {
    account.particles_by_level.push_back(in.get<std::int64_t>());
    const std::int64_t count = account.particles_by_level.back();
    if (count < 0 || count > max_bake_particles) {
      in.fail("states " + std::to_string(count) + " particles in level " + std::to_string(i) + "; 0 to " +
              std::to_string(max_bake_particles) + " are allowed");
    }
  }
  if (format < 2) return facts;
  const auto bits = in.get<std::uint8_t>();
  if (bits > all_bits || (!(bits & has_temporal) && bits & (has_tau | has_rate)))
    in.fail("has flags " + std::to_string(bits) +
            " for the facts of the frame, which this format does not allow");
  if (bits & has_temporal) account.temporal = get_temporal(in, bits, account.particles());
  if (bits & has_guards) {
    each_guard(account.guards.emplace(), [&](std::uint64_t& count) {
      count = in.get<std::uint64_t>();
      if (count > static_cast<std::uint64_t>(INT64_MAX))
        in.fail("states " + std::to_string(count) + ", an impossible number of guard cases");
    });
  }
  return facts;
}

namespace {

constexpr std::uint8_t packed_raw = 0;
constexpr std::uint8_t packed_zstd = 1;
constexpr std::size_t max_ratio = 4096;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

ZSTD_CCtx& compressor() {
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  return *context;
}

ZSTD_DCtx& decompressor() {
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  return *context;
}

}  // namespace

void pack(ByteSpan data, int zstd_level, Bytes& out) {
  const std::size_t head = out.size();
  out.resize(head + 1 + ZSTD_compressBound(data.size()));
  const std::size_t size = ZSTD_compressCCtx(&compressor(), out.data() + head + 1, out.size() - head - 1,
                                             data.data(), data.size(), zstd_level);
  const bool usable = ZSTD_isError(size) == 0 && size < data.size() && data.size() / size < max_ratio;
  out.resize(head + 1 + (usable ? size : 0));
  out[head] = usable ? packed_zstd : packed_raw;
  if (!usable) out.insert(out.end(), data.begin(), data.end());
}

void unpack(ByteReader& in, std::size_t size, Bytes& out) {
  const auto kind = in.get<std::uint8_t>();
  const ByteSpan data = in.take(in.rest().size());
  if (kind == packed_raw) {
    if (data.size() != size)
      in.fail("holds " + std::to_string(data.size()) + " bytes of data, but its counts need " +
              std::to_string(size));
    out.assign(data.begin(), data.end());
    return;
  }
  if (kind != packed_zstd) in.fail("is packed with the unknown method " + std::to_string(kind));
  if (size / max_ratio > data.size()) in.fail("states more data than its bytes can hold");
  if (ZSTD_getFrameContentSize(data.data(), data.size()) != size) {
    in.fail("holds packed data of another size than the " + std::to_string(size) +
            " bytes that its counts need");
  }
  out.resize(size);
  const std::size_t got = ZSTD_decompressDCtx(&decompressor(), out.data(), size, data.data(), data.size());
  if (ZSTD_isError(got) != 0 || got != size) in.fail("holds packed data that cannot be decompressed");
}

}  // namespace sim
