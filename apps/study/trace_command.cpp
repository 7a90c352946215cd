/// vip-study trace: makes a timing profile from captured frame times.

#include <cstdio>
#include <memory>
#include <optional>

#include "apps/common/options.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/pacing/capture.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct TraceOptions {
  std::string file, column;
  std::optional<double> seconds;
};

void print_trace(const TraceOptions& options) {
  const study::FrameCapture capture = study::read_capture(options.file, options.column, options.seconds);
  std::printf("# %s%s: %s\n", base::shortened(options.file).c_str(),
              capture.column.empty() ? "" : (", " + base::shortened(capture.column)).c_str(),
              study::describe_capture(capture).c_str());
  if (capture.left_out > 0)
    std::printf("# rows without a frame time: %lld (frames that were never shown, or the first of the log)\n",
                static_cast<long long>(capture.left_out));
  for (const std::string& remark : capture.remarks) std::printf("# %s\n", remark.c_str());
  std::printf("%s\n", study::timing_line(capture).c_str());
}

}  // namespace

void add_trace_command(CLI::App& app) {
  auto options = std::make_shared<TraceOptions>();
  CLI::App& sub = *app.add_subcommand(
      "trace", "Print the frame times of a capture as the timing of a [[factor.level]], with their moments");
  sub.add_option("file", options->file,
                 "Frame log of one window in a format of docs/session.md, or one column of frame times in ms")
      ->required();
  sub.add_option("--column", options->column,
                 "Column of frame times in ms (default: intervals between frames; without them, between "
                 "changes of the picture)");
  sub.add_option("--seconds", options->seconds, "Read the first seconds alone")->check(number_in(0.01, 3600));
  sub.callback([options] { print_trace(*options); });
}

}  // namespace apps
