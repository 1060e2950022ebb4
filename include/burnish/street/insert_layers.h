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
  InsertLayers() = default;
  /// Nothing is inserted.
  InsertLayers(int w, int h)
      : object(w, h), through(w, h, vec3<float>(1)), ground(w, h), shadow(through), kept(through), added(w, h),
        object_variance(w, h), shadow_variance(w, h) {}

  Image object;    ///< radiance of the vehicle, by its coverage
  Image through;   ///< what it lets through of what is behind it; 1 where it is not
  Image ground;    ///< of that, what is ground
  Image shadow;    ///< irradiance of the ground with the vehicle, by that without; 1 where no ground is seen
  Image kept;      ///< through, and of it the ground in the shadow
  Image added;     ///< radiance that a wet ground mirrors more, or less, for the vehicle's being there
  Image object_variance, shadow_variance;  ///< of their pixels, as far as the paths tell

  /// kept anew, of through, ground and shadow.
  void lay_shadow() {
    for (int y = 0; y < kept.height; ++y)
      for (int x = 0; x < kept.width; ++x)
        kept.set(x, y, through.at(x, y) + ground.at(x, y) * (shadow.at(x, y) - vec3<float>(1.0f)));
  }
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
/// lies behind it is hidden. grounded: whether the shadow is seen (it always falls on the ground). A few paths are
/// traced in every fourth pixel; where these, up to 6 pixels away, find nothing of the vehicle and its shadow, there is
/// none.
template <class Material, class Progress>
InsertLayers render_layers(const PathTracer<Material>& tracer, const Camera& camera, const Mask& scene_depth,
                           bool grounded, Progress progress) {
  const int w = camera.width, h = camera.height, samples = tracer.options().samples, first = std::min(samples, 4);
  const std::uint32_t seed = tracer.options().seed;
  std::vector<PlateSample> sums(std::size_t(w) * std::size_t(h));
  struct Squares {
    vec3<float> object, seen, both, all, thrown;
  };
  std::vector<Squares> squares(sums.size());
  std::vector<int> taken(sums.size());
  std::vector<std::uint8_t> busy(sums.size());
  std::mutex telling;
  int done = 0;
  const Box near = detail::shadow_reach(tracer.scene(), tracer.ground());
  const auto pass = [&](auto wanted) {
    parallel_for(h, [&](int y) {
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
        const auto [from, to] = wanted(x, y, i);
        if (from >= to) continue;
        const float hidden = scene_depth.width == w && scene_depth.height == h
                                 ? scene_depth.at(x, y)
                                 : std::numeric_limits<float>::infinity();
        for (int s = from; s < to; ++s) {
          PathNumbers random(std::uint32_t(i), std::uint32_t(s), seed);
          const PlateSample p =
              tracer.sample(camera, vec2<float>(float(x), float(y)) + random.pair(), hidden, grounded, random);
          busy[i] |= p.busy();
          Squares& q = squares[i];
          const GroundLight& g = p.ground;
          q.object += p.object * p.object, q.thrown += g.thrown * g.thrown;
          q.seen += g.seen * g.seen, q.both += g.seen * g.all, q.all += g.all * g.all;
          if (taken[i]++ == 0) sums[i] = p;
          else sums[i] += p;
        }
      }
      const std::lock_guard lock(telling);
      progress(++done, 2 * h);
    });
  };
  const auto tried = [&](int x, int y) { return x % 2 == 0 && y % 2 == 0 && detail::passes_box(camera, x, y, near); };
  pass([&](int x, int y, std::size_t) { return std::pair(0, tried(x, y) ? first : 0); });
  busy = detail::grown(std::move(busy), w, h, 6);
  pass([&](int, int, std::size_t i) { return std::pair(taken[i], busy[i] ? samples : 0); });

  InsertLayers out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
      const PlateSample& sum = sums[i];
      const float k = 1 / float(std::max(taken[i], 1));
      const vec3<float> none(0.0f), all = max(sum.ground.all, vec3<float>(1e-20f));
      out.object.set(x, y, sum.object * k), out.through.set(x, y, sum.through * k), out.added.set(x, y, sum.added * k);
      out.ground.set(x, y, sum.to_ground * k);
      const Squares& q = squares[i];
      const float n = 1 / float(std::max(taken[i] - 1, 1));
      out.object_variance.set(x, y, max(q.object * k - sum.object * sum.object * (k * k), none) * n);
      const vec3<float> seen = sum.ground.shadow();
      out.shadow.set(x, y, seen + sum.ground.thrown * k);
      // Of a ratio of sums (Cochran 1977, 2.46), and of the mean of what is thrown back.
      const vec3<float> off = q.seen - 2.0f * seen * q.both + seen * seen * q.all;
      out.shadow_variance.set(x, y, max(off, none) / (k * (all * all) * k) * (k * n) +
                                        max(q.thrown * k - sum.ground.thrown * sum.ground.thrown * (k * k), none) * n);
    }
  out.lay_shadow();
  return out;
}

}  // namespace burnish
