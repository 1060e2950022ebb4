// burnish/street/insert_layers.h -- the pictures that a vehicle is laid into a plate by, path-traced
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <mutex>
#include <vector>
#include <burnish/ad/parallel.h>
#include <burnish/street/path_tracer.h>

namespace burnish {

/// Pictures of linear RGB, height x width. The plate is what a camera saw without the vehicle:
/// composite = object + plate * (kept of the plate), see insert.h.
struct InsertLayers {
  Image object;    ///< radiance of the vehicle, by its coverage
  Image through;   ///< what it lets through of what is behind it; 1 where it is not
  Image shadow;    ///< irradiance of the ground with the vehicle, by that without; 1 where no ground is seen
  Image kept;      ///< mean of through x shadow
  Image added;     ///< radiance that a wet ground mirrors more, or less, for the vehicle's being there
};

namespace detail {
/// A pixel is set where one at most r columns and rows away was.
inline std::vector<std::uint8_t> grown(std::vector<std::uint8_t> set, int w, int h, int r) {
  for (const bool rows : {false, true}) {
    const int lines = rows ? w : h, length = rows ? h : w, step = rows ? w : 1, next = rows ? 1 : w;
    for (int line = 0; line < lines; ++line) {
      std::uint8_t* const at = set.data() + std::ptrdiff_t(line) * next;
      int last = -2 * length;  // the place of the last that was set
      std::vector<std::uint8_t> out(std::size_t(length), 0);
      for (int i = 0; i < length + r; ++i) {
        if (i < length && at[std::ptrdiff_t(i) * step]) last = i;
        const int middle = i - r;
        if (middle >= 0 && middle < length) out[std::size_t(middle)] = last >= middle - r;
      }
      for (int i = 0; i < length; ++i) at[std::ptrdiff_t(i) * step] = out[std::size_t(i)];
    }
  }
  return set;
}
/// The vehicle with the ground about it that its shadow may matter on.
inline Box shadow_reach(const Raycaster& scene, const Ground& ground) {
  Box box = bounds(scene.mesh());
  const vec3<float> size = box.size();
  const float far = 3 * std::max({size.x, size.y, size.z});
  box.low = {box.low.x - far, std::min(box.low.y, ground.height), box.low.z - far};
  box.high = {box.high.x + far, box.high.y, box.high.z + far};
  return box;
}
/// Whether the pixel's ray comes by the box.
inline bool passes_box(const Camera& c, int x, int y, const Box& near) {
  const vec3<float> d = c.toward(float(x) + 0.5f, float(y) + 0.5f), o = c.position;
  float t0 = 0, t1 = std::numeric_limits<float>::infinity();
  const auto slab = [&](float from, float to, float at, float along) {
    if (std::abs(along) < 1e-9f) return at >= from && at <= to;
    const float a = (from - at) / along, b = (to - at) / along;
    t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
    return true;
  };
  const float slack = 0.05f + 0.01f * length(o);
  return slab(near.low.x, near.high.x, o.x, d.x) && slab(near.low.y - slack, near.high.y + slack, o.y, d.y) &&
         slab(near.low.z, near.high.z, o.z, d.z) && t0 <= t1;
}
}  // namespace detail

/// scene_depth: metres along the camera's axis to what the photo shows, of the camera's size, or of no size; what
/// lies behind it is hidden. grounded: whether the shadow is seen (it always falls on the ground). A few samples are
/// taken everywhere; where these and all that lie up to 6 pixels away find nothing of the vehicle, they are all.
template <class Material, class Progress>
InsertLayers render_layers(const PathTracer<Material>& tracer, const Camera& camera, const Mask& scene_depth,
                           bool grounded, Progress progress) {
  const int w = camera.width, h = camera.height, samples = tracer.options().samples, first = std::min(samples, 4);
  const std::uint32_t seed = tracer.options().seed;
  std::vector<PlateSample> sums(std::size_t(w) * std::size_t(h));
  std::vector<int> taken(sums.size());
  std::vector<std::uint8_t> busy(sums.size());
  std::mutex telling;
  int done = 0;
  const Box near = detail::shadow_reach(tracer.scene(), tracer.ground());
  const auto pass = [&](int from, int to, auto wanted) {
    parallel_for(h, [&](int y) {
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
        if (!wanted(x, y, i)) continue;
        const float hidden = scene_depth.width == w && scene_depth.height == h
                                 ? scene_depth.at(x, y)
                                 : std::numeric_limits<float>::infinity();
        for (int s = from; s < to; ++s) {
          detail::Random random(std::uint32_t(i), std::uint32_t(s), seed);
          // The places in the pixel are spread evenly (Roberts 2018), turned by the pixel's own numbers.
          const float u = random() + 0.7548776662f * float(s), v = random() + 0.5698402910f * float(s);
          const PlateSample p = tracer.sample(
              camera, {float(x) + u - std::floor(u), float(y) + v - std::floor(v)}, hidden, grounded, random);
          busy[i] |= p.busy();
          if (taken[i]++ == 0) sums[i] = p;
          else sums[i] += p;
        }
      }
      const std::lock_guard lock(telling);
      progress(++done, 2 * h);
    });
  };
  pass(0, first, [&](int x, int y, std::size_t) { return detail::passes_box(camera, x, y, near); });
  busy = detail::grown(std::move(busy), w, h, 6);
  pass(first, samples, [&](int, int, std::size_t i) { return busy[i] && taken[i] > 0; });

  InsertLayers out{Image(w, h), Image(w, h), Image(w, h), Image(w, h), Image(w, h)};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
      const PlateSample& sum = sums[i];
      const float k = 1 / float(std::max(taken[i], 1));
      const auto positive = [](const vec3<float>& c) { return max(c, vec3<float>(0.0f)); };
      out.object.set(x, y, sum.object * k), out.through.set(x, y, sum.through * k);
      out.shadow.set(x, y, positive(sum.shadow * k)), out.kept.set(x, y, positive(sum.kept * k));
      out.added.set(x, y, sum.added * k);
    }
  return out;
}

}  // namespace burnish
