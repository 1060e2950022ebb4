// burnish/io/exr.h -- a G-buffer as one multi-layer EXR
// SPDX-License-Identifier: Apache-2.0
//
// One part, 32-bit floats, the channels named by layer as compositing programs know them; RGBA is a preview, so that
// any viewer shows something.
#pragma once
#include <burnish/io/photo.h>
#include <burnish/scene/gbuffer.h>

namespace burnish {

/// R G B A: preview (the file's colour of the part, darkened towards the silhouette, premultiplied) and coverage;
/// P: position, N: shading normal, Ng: geometric normal, T: tangent, V: to the viewer, world space; depth.Z: metres
/// along the view axis; uv.U uv.V; part.ID: index of the part. Zero where nothing was hit (part.ID -1, depth.Z 1e10).
/// The parts' names and the camera stand in the header as burnish/part/<id> and burnish/camera.
inline void write_exr(const std::string& path, const GBuffer& g) {
  struct Channel {
    const char* name;
    int plane;  // of the G-buffer; -1: made here
    float background;
  };
  static constexpr Channel channels[] = {
      {"R", -1, 0},    {"G", -1, 0},    {"B", -1, 0},    {"A", GBuffer::coverage, 0},
      {"P.X", 0, 0},   {"P.Y", 1, 0},   {"P.Z", 2, 0},   {"N.X", 3, 0},   {"N.Y", 4, 0},   {"N.Z", 5, 0},
      {"Ng.X", 15, 0}, {"Ng.Y", 16, 0}, {"Ng.Z", 17, 0}, {"T.X", 6, 0},   {"T.Y", 7, 0},   {"T.Z", 8, 0},
      {"V.X", 9, 0},   {"V.Y", 10, 0},  {"V.Z", 11, 0},  {"depth.Z", GBuffer::depth, 1e10f},
      {"uv.U", 12, 0}, {"uv.V", 13, 0}, {"part.ID", -1, -1}};
  constexpr int n = int(std::size(channels));
  std::vector<float> values(std::size_t(g.width) * g.height * n);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = channels[i % n].background;
  for (int i = 0; i < g.size(); ++i) {
    float* const to = values.data() + std::size_t(g.pixel[i]) * n;
    for (int c = 0; c < n; ++c) {
      if (channels[c].plane >= 0) to[c] = g.plane[channels[c].plane][i];
    }
    const Surfel<float> s = g.at(i);
    const vec3<float> rgb = g.parts[g.part[i]].base_color * (dot(s.normal, s.view) * g.plane[GBuffer::coverage][i]);
    to[0] = rgb.x, to[1] = rgb.y, to[2] = rgb.z;
    to[n - 1] = float(g.part[i]);
  }
  OIIO::ImageSpec spec(g.width, g.height, n, OIIO::TypeDesc::FLOAT);
  for (int c = 0; c < n; ++c) spec.channelnames[c] = channels[c].name;
  spec.alpha_channel = 3;
  spec.attribute("compression", "zip");
  for (std::size_t i = 0; i < g.parts.size(); ++i) {
    spec.attribute("burnish/part/" + std::to_string(i), g.parts[i].name + " / " + g.parts[i].material);
  }
  const Camera& c = g.camera;
  std::ostringstream text;
  text << "position " << c.position.x << " " << c.position.y << " " << c.position.z << ", forward " << c.forward.x
       << " " << c.forward.y << " " << c.forward.z << ", down " << c.down.x << " " << c.down.y << " " << c.down.z
       << ", fx " << c.fx << ", fy " << c.fy << ", cx " << c.cx << ", cy " << c.cy;
  spec.attribute("burnish/camera", text.str());
  detail::write_pixels(path, "openexr", spec, values.data());
}

}  // namespace burnish
