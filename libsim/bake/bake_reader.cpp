#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>

#include "libsim/bake/bake_file.hpp"
#include "libsim/bake/layout.hpp"

namespace sim {

namespace {

/// Reads bytes at an offset of a file or of memory.
class Source {
 public:
  Source(const std::filesystem::path& path) : name_(path.string()) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd_ < 0) {
      throw base::Error(name_, std::string("cannot be read: ") + std::strerror(errno),
                        "check the path and its permissions");
    }
    struct stat status {};
    if (::fstat(fd_, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(fd_);
      throw base::Error(name_, "is not a regular file", "name a bake file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  Source(ByteSpan memory, std::string name) : memory_(memory), size_(memory.size()), name_(std::move(name)) {}
  ~Source() {
    if (fd_ >= 0) ::close(fd_);
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  std::uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }

  /// The caller must have checked offset + size against size().
  void read(std::uint64_t offset, std::size_t size, Bytes& out) const {
    if (fd_ < 0) {
      const ByteSpan part = memory_.subspan(offset, size);
      out.assign(part.begin(), part.end());
      return;
    }
    out.resize(size);
    std::size_t done = 0;
    while (done < size) {
      const ssize_t n = ::pread(fd_, out.data() + done, size - done, static_cast<off_t>(offset + done));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        throw base::Error(name_,
                          n == 0 ? "became shorter while it was read"
                                 : std::string("cannot be read: ") + std::strerror(errno),
                          "check the disk, and bake it again");
      }
      done += static_cast<std::size_t>(n);
    }
  }

 private:
  int fd_ = -1;
  ByteSpan memory_;
  std::uint64_t size_ = 0;
  std::string name_;
};

[[noreturn]] void fail(const std::string& place, const std::string& problem) {
  throw base::Error(place, problem, "the file is damaged; bake it again");
}

bool is(ByteSpan bytes, const std::array<char, 8>& text) {
  return std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

}  // namespace

struct BakeReader::State {
  Source source;
  BakeHeader header;
  std::vector<bake::IndexEntry> particles, foam, pictures;
  std::uint64_t content_hash = 0;
  std::uint64_t body_begin = 0;  ///< first byte after the header
  std::uint32_t format = 0;
  ParticleLayout layout;

  template <typename... Args>
  explicit State(Args&&... args) : source(std::forward<Args>(args)...) {
    read_header();
    read_index();
  }

  [[noreturn]] void truncated() const {
    throw base::Error(source.name(),
                      "is truncated (" + std::to_string(source.size()) + " bytes, no end mark)",
                      "copy it again, or bake it again");
  }

  void read_header() {
    Bytes bytes;
    source.read(0, std::min<std::uint64_t>(source.size(), bake::prologue_bytes), bytes);
    const std::size_t known = std::min(bytes.size(), bake::magic.size());
    if (known == 0 || std::memcmp(bytes.data(), bake::magic.data(), known) != 0) {
      throw base::Error(source.name(), "is not a bake file", "name a file that vip-study bake wrote");
    }
    if (bytes.size() < bake::prologue_bytes) truncated();
    ByteReader in(ByteSpan(bytes).subspan(bake::magic.size()), source.name());
    const auto version = in.get<std::uint32_t>();
    if (version == 0 || version > bake_format) {
      throw base::Error(source.name(),
                        "has bake format " + std::to_string(version) + "; this program reads 1 to " +
                            std::to_string(bake_format),
                        version > bake_format ? "use a newer program, or bake it again" : "bake it again");
    }
    format = version;
    const auto size = in.get<std::uint32_t>();
    const auto checksum = in.get<std::uint64_t>();
    if (size > bake::max_header_bytes)
      fail(source.name(), "states a header of " + std::to_string(size) + " bytes; at most " +
                              std::to_string(bake::max_header_bytes) + " are allowed");
    if (source.size() < bake::prologue_bytes + size + bake::footer_bytes) truncated();
    source.read(bake::prologue_bytes, size, bytes);
    if (XXH3_64bits(bytes.data(), bytes.size()) != checksum) fail(source.name(), "has a damaged header");
    header = parse_bake_header(bytes, format, source.name());
    layout = {format, header.radius_by_level_m, header.max_particles, header.reference_k.has_value()};
    body_begin = bake::prologue_bytes + size;
  }

  void read_index() {
    Bytes footer, bytes;
    source.read(source.size() - bake::footer_bytes, bake::footer_bytes, footer);
    if (!is(ByteSpan(footer).last(bake::end_magic.size()), bake::end_magic)) truncated();
    ByteReader in(footer, source.name());
    const auto offset = in.get<std::uint64_t>();
    const auto chunks = in.get<std::uint64_t>();
    const auto checksum = in.get<std::uint64_t>();
    content_hash = in.get<std::uint64_t>();
    const std::uint64_t end = source.size() - bake::footer_bytes;
    if (chunks > 3 * bake::max_frames || offset < body_begin || offset > end ||
        end - offset != chunks * bake::entry_bytes) {
      fail(source.name(), "has a damaged footer");
    }
    source.read(offset, static_cast<std::size_t>(end - offset), bytes);
    if (XXH3_64bits(bytes.data(), bytes.size()) != checksum) fail(source.name(), "has a damaged index");
    sort_index(bytes, chunks, offset);
  }

  /// Kind that the next chunk of the index must have.
  bake::ChunkKind next_kind() const {
    if (header.max_foam > 0 && foam.size() < particles.size()) return bake::ChunkKind::Foam;
    if (!header.has_pictures() || pictures.size() == particles.size()) return bake::ChunkKind::Particles;
    const bool key = pictures.size() % static_cast<std::size_t>(bake::key_interval) == 0;
    return key ? bake::ChunkKind::KeyPicture : bake::ChunkKind::Picture;
  }

  /// Sorts the index by kind. Checks that chunks are contiguous from the header to the index, and ordered by
  /// frame.
  void sort_index(ByteSpan bytes, std::uint64_t chunks, std::uint64_t end) {
    ByteReader in(bytes, source.name());
    std::uint64_t next = body_begin;
    for (std::uint64_t i = 0; i < chunks; ++i) {
      bake::IndexEntry entry;
      entry.kind = static_cast<bake::ChunkKind>(in.get<std::uint32_t>());
      entry.offset = in.get<std::uint64_t>();
      entry.size = in.get<std::uint64_t>();
      entry.checksum = in.get<std::uint64_t>();
      if (entry.offset != next || entry.size > end - next) fail(source.name(), "has an index with gaps");
      next += entry.size;
      const bake::ChunkKind wanted = next_kind();
      if (entry.kind != wanted) fail(source.name(), "has chunks in an unknown order");
      (wanted == bake::ChunkKind::Particles ? particles
       : wanted == bake::ChunkKind::Foam    ? foam
                                            : pictures)
          .push_back(entry);
    }
    const auto frames = static_cast<std::size_t>(header.frame_count);
    if (next != end || particles.size() != frames || foam.size() != (header.max_foam > 0 ? frames : 0) ||
        pictures.size() != (header.has_pictures() ? frames : 0)) {
      fail(source.name(), "has chunks for " + std::to_string(particles.size()) + " frames, " +
                              std::to_string(foam.size()) + " frames of foam and " +
                              std::to_string(pictures.size()) + " pictures for the " +
                              std::to_string(frames) +
                              " frames of its header, or bytes between the last chunk and the index");
    }
  }

  void read_chunk(const bake::IndexEntry& entry, const std::string& place, Bytes& out) const {
    source.read(entry.offset, static_cast<std::size_t>(entry.size), out);
    if (XXH3_64bits(out.data(), out.size()) != entry.checksum) fail(place, "does not match its checksum");
  }

  const bake::IndexEntry& at(const std::vector<bake::IndexEntry>& entries, std::int64_t frame) const {
    if (frame < 0 || frame >= static_cast<std::int64_t>(entries.size())) {
      throw base::Error(source.name(), "has no frame " + std::to_string(frame),
                        "use a frame number from 0 to below " + std::to_string(entries.size()));
    }
    return entries[static_cast<std::size_t>(frame)];
  }
};

BakeReader::BakeReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
BakeReader::BakeReader(ByteSpan bytes, const std::string& name)
    : state_(std::make_unique<State>(bytes, name)) {}
BakeReader::~BakeReader() = default;

const BakeHeader& BakeReader::header() const { return state_->header; }
std::string BakeReader::content_hash() const { return fmt::format("{:016x}", state_->content_hash); }
std::uint64_t BakeReader::file_bytes() const { return state_->source.size(); }

void BakeReader::read_frame(std::int64_t frame, BakeFrame& out) const {
  const State& s = *state_;
  thread_local Bytes chunk, scratch;
  const std::string place = bake::frame_place(s.source.name(), "frame", frame);
  s.read_chunk(s.at(s.particles, frame), place, chunk);
  decode_particles(chunk, s.layout, place, scratch, out);
  out.foam.clear();
  if (s.header.max_foam == 0) return;
  const std::string foam_place = bake::frame_place(s.source.name(), "foam", frame);
  s.read_chunk(s.at(s.foam, frame), foam_place, chunk);
  decode_foam(chunk, s.header.max_foam, foam_place, scratch, out.foam);
}

const BakePicture& PictureReader::read(std::int64_t frame) {
  if (frame == have_) return picture_;
  const std::int64_t key = frame - frame % bake::key_interval;
  const bool onwards = have_ >= key && have_ < frame;
  for (std::int64_t i = onwards ? have_ + 1 : key; i <= frame; ++i) decode(i);
  return picture_;
}

void PictureReader::decode(std::int64_t frame) {
  const BakeReader::State& s = *bake_.state_;
  const std::string place = bake::frame_place(s.source.name(), "picture", frame);
  const bake::IndexEntry& entry = s.at(s.pictures, frame);
  s.read_chunk(entry, place, chunk_);
  have_ = -1;
  std::swap(picture_, previous_);
  const bool key = entry.kind == bake::ChunkKind::KeyPicture;
  decode_picture(chunk_, s.format, s.header.radius_by_level_m.size(),
                 key ? ByteSpan() : ByteSpan(previous_.rgba), s.header.picture_width_px,
                 s.header.picture_height_px, place, scratch_, picture_);
  have_ = frame;
}

}  // namespace sim
