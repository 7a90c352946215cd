#include <xxhash.h>

#include <cstdio>

#include "libsim/bake/bake_file.hpp"
#include "libsim/bake/layout.hpp"
#include "stats/base/new_file.hpp"

namespace sim {

namespace fs = std::filesystem;

// Levels 1 to 6 give particle chunks of nearly the same size (measured on SingleDam); level 1 is the fastest.
constexpr int particle_zstd_level = 1;
constexpr int picture_zstd_level = 3;

struct BakeWriter::State {
  fs::path path;
  BakeHeader header;
  std::optional<base::NewFile> file;
  std::uint64_t offset = 0;
  std::vector<bake::IndexEntry> index;
  XXH3_state_t* content = nullptr;
  std::int64_t frames = 0, foams = 0, pictures = 0;
  BakeFacts facts;
  Bytes chunk, previous;
  BakeSizes sizes;

  ~State() { XXH3_freeState(content); }

  /// True if every frame added so far has its foam and its picture, as far as the header requires them.
  bool complete() const {
    return (header.max_foam == 0 || foams == frames) && (!header.has_pictures() || pictures == frames);
  }

  void open(bool overwrite) {
    check_target(path, overwrite);
    base::remove_stale_drafts(path);
    file.emplace(path);
    content = XXH3_createState();
    if (!content) throw std::bad_alloc();
    XXH3_64bits_reset(content);
  }

  void write(ByteSpan bytes) {
    file->write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    offset += bytes.size();
  }

  void write_header() {
    const Bytes body = format_bake_header(header);
    Bytes bytes;
    ByteWriter out(bytes);
    out.bytes(bake::as_bytes(bake::magic));
    out.put(format_of(header));
    out.put(static_cast<std::uint32_t>(body.size()));
    out.put(static_cast<std::uint64_t>(XXH3_64bits(body.data(), body.size())));
    out.bytes(body);
    XXH3_64bits_update(content, body.data(), body.size());
    write(bytes);
  }

  void write_chunk(bake::ChunkKind kind) {
    const bake::IndexEntry entry{kind, offset, chunk.size(), XXH3_64bits(chunk.data(), chunk.size())};
    write(chunk);
    index.push_back(entry);
    XXH3_64bits_update(content, &entry.checksum, sizeof entry.checksum);
  }

  void write_index() {
    Bytes bytes;
    ByteWriter out(bytes);
    for (const bake::IndexEntry& entry : index) {
      out.put(static_cast<std::uint32_t>(entry.kind));
      out.put(entry.offset);
      out.put(entry.size);
      out.put(entry.checksum);
    }
    const std::uint64_t checksum = XXH3_64bits(bytes.data(), bytes.size());
    out.put(offset);
    out.put(static_cast<std::uint64_t>(index.size()));
    out.put(checksum);
    out.put(static_cast<std::uint64_t>(XXH3_64bits_digest(content)));
    out.bytes(bake::as_bytes(bake::end_magic));
    write(bytes);
  }
};

void BakeWriter::check_target(const fs::path& path, bool overwrite) {
  std::error_code ignored;
  if (!overwrite && fs::exists(fs::symlink_status(path, ignored))) {
    throw base::Error(path.string(), "exists already", "name another file, or overwrite it with --force");
  }
  base::check_output(path);
}

BakeWriter::BakeWriter(const fs::path& path, const BakeHeader& header, bool overwrite)
    : state_(std::make_unique<State>()) {
  state_->path = path;
  state_->header = header;
  parse_bake_header(format_bake_header(header), format_of(header), path.string());
  state_->open(overwrite);
  state_->write_header();
}

BakeWriter::~BakeWriter() = default;

void BakeWriter::add_frame(double time_s, const std::vector<RenderParticle>& particles,
                           const FrameAccount& account, const std::vector<float>& temperature_k) {
  State& s = *state_;
  const std::string place = bake::frame_place(s.path.string(), "frame", s.frames);
  if (s.frames == s.header.frame_count || !s.complete())
    throw std::logic_error(
        "BakeWriter::add_frame: all frame_count frames were added, or the last one lacks its foam or "
        "picture; "
        "state all frames in the header, and call add_foam() and add_picture() before the next frame");
  if (particles.size() > static_cast<std::size_t>(s.header.max_particles)) {
    throw base::Error(place,
                      "has " + std::to_string(particles.size()) +
                          " particles, more than max_particles of the header, " +
                          std::to_string(s.header.max_particles),
                      "make max_particles of the header larger");
  }
  const bool warm = s.header.reference_k.has_value();
  if (temperature_k.size() != (warm ? particles.size() : 0))
    throw std::logic_error(
        "BakeWriter::add_frame: temperatures do not fit the header; pass one per particle if the header has "
        "reference_k, otherwise none");
  encode_particles(time_s, account, particles, s.header.radius_by_level_m, warm ? &temperature_k : nullptr,
                   particle_zstd_level, place, s.chunk);
  ByteReader facts(s.chunk, place);
  s.facts = get_facts(facts, bake_format, s.header.radius_by_level_m.size());
  s.write_chunk(bake::ChunkKind::Particles);
  s.sizes.particle_bytes += s.chunk.size();
  ++s.frames;
}

void BakeWriter::add_foam(const std::vector<RenderParticle>& foam) {
  State& s = *state_;
  if (s.header.max_foam == 0 || s.foams + 1 != s.frames || s.pictures == s.frames)
    throw std::logic_error(
        "BakeWriter::add_foam: max_foam of the header is 0, or no frame waits for foam; call it once after "
        "each add_frame() and before add_picture(), if max_foam is above 0");
  const std::string place = bake::frame_place(s.path.string(), "foam", s.foams);
  if (foam.size() > static_cast<std::size_t>(s.header.max_foam))
    throw base::Error(place,
                      "has " + std::to_string(foam.size()) +
                          " particles of foam, more foam than max_foam of the header, " +
                          std::to_string(s.header.max_foam),
                      "make max_foam of the header larger");
  encode_foam(foam, particle_zstd_level, place, s.chunk);
  s.write_chunk(bake::ChunkKind::Foam);
  s.sizes.foam_bytes += s.chunk.size();
  ++s.foams;
}

void BakeWriter::add_picture(ByteSpan rgba) {
  State& s = *state_;
  const auto bytes = static_cast<std::size_t>(s.header.picture_width_px) *
                     static_cast<std::size_t>(s.header.picture_height_px) * 4;
  const bool foam_missing = s.header.max_foam > 0 && s.foams != s.frames;
  if (!s.header.has_pictures() || s.pictures + 1 != s.frames || foam_missing || rgba.size() != bytes) {
    throw std::logic_error(
        "BakeWriter::add_picture: the header states no pictures or another size, no frame waits for a "
        "picture, "
        "or the frame's foam is missing; call it once per frame, after add_foam() if max_foam is above 0");
  }
  const bool key = s.pictures % bake::key_interval == 0;
  encode_picture(s.facts, rgba, key ? ByteSpan() : ByteSpan(s.previous), s.header.picture_width_px,
                 s.header.picture_height_px, picture_zstd_level, s.chunk);
  s.write_chunk(key ? bake::ChunkKind::KeyPicture : bake::ChunkKind::Picture);
  s.sizes.picture_bytes += s.chunk.size();
  s.previous.assign(rgba.begin(), rgba.end());
  ++s.pictures;
}

BakeSizes BakeWriter::finish() {
  State& s = *state_;
  if (s.frames != s.header.frame_count || !s.complete())
    throw std::logic_error(
        "BakeWriter::finish: fewer than frame_count frames were added, or the last one lacks its foam or "
        "picture; add them first");
  s.write_index();
  s.file->put_in_place();
  s.sizes.file_bytes = s.offset;
  return s.sizes;
}

}  // namespace sim
