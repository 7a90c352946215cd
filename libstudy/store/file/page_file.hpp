#pragma once
/// Reads the pages of a SQLite database file and of its log directly, without SQLite. The format:
/// https://www.sqlite.org/fileformat2.html

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace study::salvaging {

/// The first bytes of a database file (section 1.3 of the format) and of a rollback journal (section 3).
inline constexpr std::string_view database_magic("SQLite format 3\0", 16);
inline constexpr std::string_view rollback_magic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
/// header_bytes: size of the database header, with which the first page begins. version_at and
/// application_at: offsets of the fields user_version and application_id in the header.
inline constexpr std::size_t header_bytes = 100, version_at = 60, application_at = 68;

/// The bytes as an unsigned number, most significant byte first.
std::uint64_t big_endian(std::string_view bytes);
/// The four bytes from offset `at` on as a number, most significant byte first; 0 if `bytes` ends before.
std::uint32_t u32(std::string_view bytes, std::size_t at);

/// A file for reading; a missing file reads as empty. base::Error if an existing file cannot be opened, or if
/// reading fails for another reason than a disk error (EIO).
class File {
 public:
  explicit File(const std::filesystem::path& path);
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::size_t size() const { return size_; }
  /// Reads `count` bytes from offset `at` on, fewer at the end of the file. If the disk fails to read a part,
  /// the result has zeros from there on.
  std::string read(std::size_t at, std::size_t count) const;

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  int fd_;
  std::size_t size_ = 0;
};

/// Index of the newest version of each page in a write-ahead log, up to the log's last commit.
class Log {
 public:
  explicit Log(const std::filesystem::path& path);

  /// Size of a page, bytes; 0 if there is no log with a valid header.
  std::size_t page_bytes() const { return page_bytes_; }
  std::size_t page_count() const { return page_count_; }
  bool holds(std::size_t page) const { return places_.contains(page); }
  bool is_empty() const { return commits_ == 0; }
  std::size_t commits() const { return commits_; }
  /// The first 100 bytes of page 1 from each commit that wrote it, in order.
  std::vector<std::string> heads() const;
  /// Reads the newest version of a page; holds(page) must be true.
  std::string read(std::size_t page) const { return file_.read(places_.at(page), page_bytes_); }

 private:
  bool read_header(std::string_view head);
  void read_frames(std::string_view head);

  File file_;
  bool big_ = false;
  std::uint32_t first_ = 0, second_ = 0;  // the log's two checksums, up to the frame read last
  std::size_t page_bytes_ = 0, page_count_ = 0, commits_ = 0;
  std::map<std::size_t, std::size_t> places_;  // offset of each page in the log, by page number
  std::vector<std::size_t> first_pages_;       // offset of each committed version of page 1 in the log
};

/// The pages of a database, numbered from 1. A page in the log "<path>-wal" replaces the page in the file.
class Pages {
 public:
  /// use_log false: ignores the log, e.g. because the log belongs to another database.
  explicit Pages(const std::filesystem::path& path, bool use_log = true);

  std::size_t count() const { return count_; }
  /// Number of bytes of a page that SQLite uses: page size minus the reserved bytes at its end.
  std::size_t usable() const { return page_bytes_ - reserved_; }
  /// True if the page is in SQLite's list of free pages.
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
