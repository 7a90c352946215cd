#pragma once
/// The pages of a database file as its bytes and those of its log have them, without SQLite.
/// The format: https://www.sqlite.org/fileformat2.html

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace study::salvaging {

std::uint64_t big_endian(std::string_view bytes);
/// Four bytes as a number; 0 behind the end.
std::uint32_t u32(std::string_view bytes, std::size_t at);

/// A file that may be missing, which is as good as empty. base::Error when it cannot be read.
class File {
 public:
  explicit File(const std::filesystem::path& path);
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::size_t size() const { return size_; }
  /// Shorter at the end. A sector that the disk cannot read is as good as zeros.
  std::string read(std::size_t at, std::size_t count) const;

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  int fd_;
  std::size_t size_ = 0;
};

/// Which page stands where in a log, as of its last commit.
class Log {
 public:
  explicit Log(const std::filesystem::path& path);

  /// 0: there is no log.
  std::size_t page_bytes() const { return page_bytes_; }
  std::size_t page_count() const { return page_count_; }
  bool holds(std::size_t page) const { return places_.contains(page); }
  bool is_empty() const { return commits_ == 0; }
  std::size_t commits() const { return commits_; }
  /// The first 100 bytes of page 1, once for each commit that wrote it, in their order.
  std::vector<std::string> heads() const;
  /// A page that it holds.
  std::string read(std::size_t page) const { return file_.read(places_.at(page), page_bytes_); }

 private:
  bool read_header(std::string_view head);
  void read_frames(std::string_view head);

  File file_;
  bool big_ = false;
  std::uint32_t first_ = 0, second_ = 0;  // checksums so far
  std::size_t page_bytes_ = 0, page_count_ = 0, commits_ = 0;
  std::map<std::size_t, std::size_t> places_;
  std::vector<std::size_t> first_pages_;  // where each version of page 1 stands
};

/// The pages of a database, those in its log "<path>-wal" in place of the older ones. Numbers count from 1.
class Pages {
 public:
  /// Of the first page these come before what is on every page.
  static constexpr std::size_t header_bytes = 100;

  /// `use_log` false: a log that stands there is of another database.
  explicit Pages(const std::filesystem::path& path, bool use_log = true);

  std::size_t count() const { return count_; }
  /// Bytes of a page that hold cells.
  std::size_t usable() const { return page_bytes_ - reserved_; }
  /// As far as the first page tells.
  bool is_free(std::size_t page) const { return free_.contains(page); }
  std::string read(std::size_t page) const;

 private:
  void find_free(std::size_t trunk);

  File file_;
  Log log_;
  std::size_t page_bytes_ = 0, count_ = 0, reserved_ = 0;
  std::set<std::size_t> free_;
};

}  // namespace study::salvaging
