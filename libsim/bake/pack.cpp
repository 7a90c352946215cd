#include <zstd.h>

#include <cmath>
#include <memory>

#include "libsim/bake/codec.hpp"

namespace sim {

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
    if (data.size() != size) in.fail("holds another number of bytes than its counts say");
    out.assign(data.begin(), data.end());
    return;
  }
  if (kind != packed_zstd) in.fail("is packed in an unknown way");
  if (size / max_ratio > data.size()) in.fail("states more data than its bytes can hold");
  if (ZSTD_getFrameContentSize(data.data(), data.size()) != size) {
    in.fail("holds another number of bytes than its counts say");
  }
  out.resize(size);
  const std::size_t got = ZSTD_decompressDCtx(&decompressor(), out.data(), size, data.data(), data.size());
  if (ZSTD_isError(got) != 0 || got != size) in.fail("does not decompress");
}

}  // namespace sim
