#include "libstudy/store/export/bids_writer.hpp"

#include <zlib.h>

#include <algorithm>

#include "stats/base/error.hpp"

namespace study::bids {

namespace {

constexpr double ns_per_s = 1e9;

std::string lines_of(const Table& rows, std::size_t first) {
  std::string text;
  for (std::size_t i = first; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows[i].size(); ++j) text += (j ? "\t" : "") + rows[i][j];
    text += '\n';
  }
  return text;
}

/// Compresses a text by gzip. Adding 16 to zlib's window bits gives a gzip header without file name and time.
std::string gzip(std::string text, const std::string& name) {
  z_stream stream{};
  bool good =
      deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK;
  std::string out(good ? deflateBound(&stream, text.size()) : 0, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(text.data());
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  good = good && deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (!good) throw base::Error(name, "cannot be compressed", "free memory and export again");
  return out;
}

}  // namespace

std::string field(std::string text) {
  for (char& c : text) {
    if (c == '\t' || c == '\n' || c == '\r') c = ' ';
  }
  return text.empty() ? "n/a" : formula_guarded(text);
}

std::string field(const sqlite::Statement& row, int column) {
  if (row.is_null(column)) return "n/a";
  if (row.is_text(column)) return field(row.text(column));
  return row.is_real(column) ? number_text(row.real(column)) : row.text(column);
}

std::string seconds(std::int64_t ns) { return number_text(static_cast<double>(ns) / ns_per_s); }

namespace {
std::string with_n_a(std::string meaning) {
  if (const auto at = meaning.find("empty:"); at != std::string::npos) meaning.replace(at, 5, "n/a");
  return meaning;
}
}  // namespace

Json described(const std::string& meaning) { return {{"Description", with_n_a(meaning)}}; }
Json described(const std::string& meaning, const std::string& unit) {
  return {{"Description", with_n_a(meaning)}, {"Units", unit}};
}

std::string stem_of(const LabelledSession& session, const std::string& data_type) {
  const std::string sub = "sub-" + session.subject, ses = "ses-" + session.session;
  return sub + "/" + ses + "/" + data_type + "/" + sub + "_" + ses + "_task-" + session.protocol;
}

void Writer::table(const std::string& name, const Table& rows) {
  text(name, lines_of(rows, 0));
  files.push_back({name, static_cast<std::int64_t>(rows.size()) - 1});
}

void Writer::bare_table(const std::string& name, const Table& rows) {
  text(name, lines_of(rows, 1));
  files.push_back({name, static_cast<std::int64_t>(rows.size()) - 1});
}

void Writer::compressed_table(const std::string& name, const Table& rows) {
  text(name, gzip(lines_of(rows, 1), name));
  files.push_back({name, static_cast<std::int64_t>(rows.size()) - 1});
}

void Writer::text(const std::string& name, const std::string& text) {
  ExportFile file(draft_, name);
  file.write(text);
  file.finish();
}

std::int64_t SessionTime::onset_of(std::int64_t start_ns, std::optional<std::int64_t> end_ns) {
  if (!zero_ns_)
    zero_ns_ = start_ns;
  else if (start_ns - *zero_ns_ < end_ns_)
    zero_ns_ = start_ns - end_ns_;  // the clock of a new process began anew
  const std::int64_t onset = start_ns - *zero_ns_;
  end_ns_ = std::max(onset, end_ns ? *end_ns - *zero_ns_ : onset);
  return onset;
}

}  // namespace study::bids
