#include "libstudy/store/file/page_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <optional>

#include "stats/base/error.hpp"

namespace study::salvaging {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t default_page_bytes = 4096, wal_header_bytes = 32, frame_header_bytes = 24;

std::optional<std::size_t> page_size(std::uint64_t bytes) {
  if (bytes == 1) return 65536;
  if (bytes < 512 || bytes > 65536 || !std::has_single_bit(bytes)) return {};
  return bytes;
}

/// Adds bytes to the two sums of a log's checksum; `big`: the log's words are big-endian.
void add(std::uint32_t& first, std::uint32_t& second, std::string_view bytes, bool big) {
  const auto word = [&](std::size_t at) {
    const std::uint32_t value = u32(bytes, at);
    return big ? value : __builtin_bswap32(value);
  };
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    first += word(at) + second;
    second += word(at + 4) + first;
  }
}

}  // namespace

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  return at + 4 <= bytes.size() ? static_cast<std::uint32_t>(big_endian(bytes.substr(at, 4))) : 0;
}

File::File(const fs::path& path) : path_(path), fd_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (fd_ < 0 && errno != ENOENT) fail();
  const off_t end = fd_ < 0 ? 0 : ::lseek(fd_, 0, SEEK_END);
  size_ = end > 0 ? static_cast<std::size_t>(end) : 0;
}

File::~File() {
  if (fd_ >= 0) ::close(fd_);
}

std::string File::read(std::size_t at, std::size_t count) const {
  if (at >= size_) return {};
  std::string bytes(std::min(count, size_ - at), '\0');
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::pread(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno != EIO) fail();
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  return bytes;
}

void File::fail() const {
  throw base::Error(path_.string(), std::string("cannot be read: ") + std::strerror(errno),
                    "check the path and its permissions");
}

Log::Log(const fs::path& path) : file_(path) {
  const std::string head = file_.read(0, wal_header_bytes);
  if (read_header(head)) read_frames(head);
}

bool Log::read_header(std::string_view head) {
  if (head.size() < wal_header_bytes || (u32(head, 0) & ~1U) != 0x377f0682) return false;
  const auto bytes = page_size(u32(head, 8));
  if (!bytes) return false;
  page_bytes_ = *bytes;
  big_ = (u32(head, 0) & 1U) != 0;
  add(first_, second_, head.substr(0, 24), big_);
  return true;
}

void Log::read_frames(std::string_view head) {
  std::map<std::size_t, std::size_t> open;
  for (std::size_t at = wal_header_bytes; at + frame_header_bytes + page_bytes_ <= file_.size();
       at += frame_header_bytes + page_bytes_) {
    const std::string frame = file_.read(at, frame_header_bytes + page_bytes_);
    if (frame.compare(8, 8, head, 16, 8) != 0) return;  // an old frame, from before the log was restarted
    add(first_, second_, std::string_view(frame).substr(0, 8), big_);
    add(first_, second_, std::string_view(frame).substr(frame_header_bytes), big_);
    if (u32(frame, 16) != first_ || u32(frame, 20) != second_) return;
    open[u32(frame, 0)] = at + frame_header_bytes;
    if (u32(frame, 4) == 0) continue;
    for (const auto& [page, place] : open) places_[page] = place;
    if (open.contains(1)) first_pages_.push_back(open.at(1));
    open.clear();
    ++commits_;
    page_count_ = u32(frame, 4);
  }
}

std::vector<std::string> Log::heads() const {
  std::vector<std::string> heads;
  for (const std::size_t place : first_pages_) heads.push_back(file_.read(place, header_bytes));
  return heads;
}

Pages::Pages(const fs::path& path, bool use_log)
    : file_(path), log_(use_log ? fs::path(path.string() + "-wal") : fs::path()) {
  const std::string head = log_.holds(1) ? log_.read(1).substr(0, header_bytes) : file_.read(0, header_bytes);
  const auto told =
      head.starts_with("SQLite format 3") ? page_size(big_endian(head.substr(16, 2))) : std::nullopt;
  if (told && head.size() > 20) reserved_ = static_cast<unsigned char>(head[20]);
  page_bytes_ = log_.page_bytes() ? log_.page_bytes() : told.value_or(default_page_bytes);
  count_ = std::max((file_.size() + page_bytes_ - 1) / page_bytes_, log_.page_count());
  if (told) find_free(u32(head, 32));
}

std::string Pages::read(std::size_t page) const {
  return log_.holds(page) ? log_.read(page) : file_.read((page - 1) * page_bytes_, page_bytes_);
}

void Pages::find_free(std::size_t trunk) {
  while (trunk > 1 && trunk <= count_ && free_.insert(trunk).second) {
    const std::string page = read(trunk);
    const std::size_t leaves = std::min<std::size_t>(u32(page, 4), page.size() / 4);
    for (std::size_t i = 0; i < leaves; ++i) free_.insert(u32(page, 8 + 4 * i));
    trunk = u32(page, 0);
  }
}

}  // namespace study::salvaging
