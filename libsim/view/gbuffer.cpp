#include "libsim/view/gbuffer.hpp"

#include <cstring>
#include <string>
#include <string_view>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace sim {

namespace {

constexpr std::string_view magic = "VIPGBUF1";
constexpr std::size_t max_file_bytes = std::size_t{2} << 30;
constexpr std::int32_t max_side_px = 16384;

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

struct Header {
  std::int32_t width, height;
  std::int32_t viewport[4];
  float radius_scale;
  std::int32_t reserved;
  double near_m, far_m;
  Mat4 view, projection;
};

struct PlaneReader {
  std::string_view rest;
  template <class T>
  void take(T* out, std::size_t count) {
    std::memcpy(out, rest.data(), count * sizeof(T));
    rest.remove_prefix(count * sizeof(T));
  }
};

constexpr std::size_t bytes_per_pixel = 4 * 8;

}  // namespace

std::string gbuffer_bytes(const GBuffer& g, const std::string& place) {
  const auto pixels = static_cast<std::size_t>(g.width) * static_cast<std::size_t>(g.height);
  for (const std::size_t size : {g.depth.size(), g.filtered_depth.size(), g.normal.size() / 3,
                                 g.thickness.size(), g.front.size(), g.radius.size()}) {
    if (size != pixels || pixels == 0)
      throw base::Error(place,
                        "an array of the G-buffer holds " + std::to_string(size) +
                            " px, and width x height are " + std::to_string(g.width) + " x " +
                            std::to_string(g.height) + " px",
                        "fill every array for width x height px, at least 1 x 1");
  }
  const Viewport& v = g.view.viewport;
  const Header header{g.width,        g.height,    {v.x, v.y, v.width, v.height},
                      g.radius_scale, 0,           g.view.near_m,
                      g.view.far_m,   g.view.view, g.view.projection};
  std::string bytes(magic);
  append(bytes, &header, 1);
  for (const auto* values : {&g.depth, &g.filtered_depth, &g.normal, &g.thickness, &g.radius}) {
    append(bytes, values->data(), values->size());
  }
  append(bytes, g.front.data(), g.front.size());
  return bytes;
}

GBuffer gbuffer_of(std::string_view bytes, const std::string& place) {
  const std::string mend = "write the file again with this version of the program";
  if (!bytes.starts_with(magic)) throw base::Error(place, "holds no G-buffer of version 1", mend);
  PlaneReader reader{bytes.substr(magic.size())};
  if (reader.rest.size() < sizeof(Header))
    throw base::Error(place, "is cut short in the header of the G-buffer", mend);
  Header header;
  reader.take(&header, 1);
  if (header.width < 1 || header.height < 1 || header.width > max_side_px || header.height > max_side_px) {
    throw base::Error(place,
                      "holds a G-buffer of " + std::to_string(header.width) + " x " +
                          std::to_string(header.height) + " px, which is not 1 to " +
                          std::to_string(max_side_px) + " px a side",
                      mend);
  }
  const auto pixels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  if (reader.rest.size() != pixels * bytes_per_pixel) {
    throw base::Error(place,
                      "holds " + std::to_string(reader.rest.size()) + " bytes of pixels, not " +
                          std::to_string(pixels * bytes_per_pixel),
                      mend);
  }
  GBuffer g;
  g.width = header.width;
  g.height = header.height;
  g.radius_scale = header.radius_scale;
  g.view = {header.view,
            header.projection,
            {header.viewport[0], header.viewport[1], header.viewport[2], header.viewport[3]},
            header.near_m,
            header.far_m};
  g.normal.resize(3 * pixels);
  for (auto* values : {&g.depth, &g.filtered_depth, &g.thickness, &g.radius}) values->resize(pixels);
  for (auto* values : {&g.depth, &g.filtered_depth, &g.normal, &g.thickness, &g.radius}) {
    reader.take(values->data(), values->size());
  }
  g.front.resize(pixels);
  reader.take(g.front.data(), pixels);
  return g;
}

void write_gbuffer(const std::filesystem::path& path, const GBuffer& gbuffer) {
  base::write_file_atomically(path, gbuffer_bytes(gbuffer, path.string()));
}

GBuffer read_gbuffer(const std::filesystem::path& path) {
  return gbuffer_of(base::read_file(path, max_file_bytes), path.string());
}

}  // namespace sim
