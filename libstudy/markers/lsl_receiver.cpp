/// Markers as a stream of the Lab Streaming Layer.

#include "libstudy/base/clock.hpp"
#include "libstudy/markers/lsl_library.hpp"
#include "libstudy/markers/receiver.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// The functions of liblsl that are used, as its interface for C declares them (lsl_streaminfo and lsl_outlet
/// are pointers).
struct LslFunctions {
  void* (*create_streaminfo)(const char* name, const char* type, std::int32_t channels, double rate_hz,
                             int format, const char* source);
  void (*destroy_streaminfo)(void* info);
  void* (*create_outlet)(void* info, std::int32_t chunk, std::int32_t buffered);
  void (*destroy_outlet)(void* outlet);
  std::int32_t (*have_consumers)(void* outlet);
  std::int32_t (*push_sample_strtp)(void* outlet, const char** sample, double time_s, std::int32_t at_once);
  double (*local_clock)();
};

constexpr int format_string = 3;      // cft_string
constexpr double irregular_rate = 0;  // LSL_IRREGULAR_RATE
constexpr std::int32_t buffered = 360;

class LslReceiver final : public MarkerReceiver {
 public:
  LslReceiver(const std::string& place, const std::string& name) {
    void* library = open_lsl_library(place);
    find_lsl_function(library, place, "lsl_create_streaminfo", lsl_.create_streaminfo);
    find_lsl_function(library, place, "lsl_destroy_streaminfo", lsl_.destroy_streaminfo);
    find_lsl_function(library, place, "lsl_create_outlet", lsl_.create_outlet);
    find_lsl_function(library, place, "lsl_destroy_outlet", lsl_.destroy_outlet);
    find_lsl_function(library, place, "lsl_have_consumers", lsl_.have_consumers);
    find_lsl_function(library, place, "lsl_push_sample_strtp", lsl_.push_sample_strtp);
    find_lsl_function(library, place, "lsl_local_clock", lsl_.local_clock);
    // A recorder finds the stream of a resumed session again by its source.
    void* info = lsl_.create_streaminfo(name.c_str(), "Markers", 1, irregular_rate, format_string,
                                        ("vip-study " + name).c_str());
    if (info) outlet_ = lsl_.create_outlet(info, 0, buffered);
    if (info) lsl_.destroy_streaminfo(info);
    if (!outlet_)
      throw base::Error(place, "liblsl made no stream of this name",
                        "see its message above; try a plain name, such as lsl:vip-study");
  }
  ~LslReceiver() override { lsl_.destroy_outlet(outlet_); }

  std::string write(const Marker& marker, std::int64_t) override {
    if (lsl_.have_consumers(outlet_) == 0) return "no recorder listens to the stream";
    const std::string tags = marker_tags(marker);
    const char* sample = tags.c_str();
    const double ago_s = 1e-9 * static_cast<double>(RealClock().now_ns() - marker.clock_ns);
    const std::int32_t code = lsl_.push_sample_strtp(outlet_, &sample, lsl_.local_clock() - ago_s, 1);
    return code == 0 ? "" : "liblsl returned error " + std::to_string(code);
  }

 private:
  LslFunctions lsl_{};
  void* outlet_ = nullptr;
};

}  // namespace

std::unique_ptr<MarkerReceiver> open_lsl_receiver(const std::string& text, const std::string& rest) {
  return std::make_unique<LslReceiver>(text, rest);
}

}  // namespace study
