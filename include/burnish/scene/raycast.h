// burnish/scene/raycast.h -- rays against a mesh: the G-buffer of a camera, and which directions are blocked
// SPDX-License-Identifier: Apache-2.0
//
// By Embree. Rays go in packets of 16, on all cores; the result does not depend on how many there are. Both sides of a
// triangle are hit.
#pragma once
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <burnish/ad/parallel.h>
#include <burnish/math/sequence.h>
#include <burnish/scene/embree.h>
#include <burnish/scene/error.h>
#include <burnish/scene/surface_at.h>

namespace burnish {

class Raycaster {
public:
  static constexpr int packet = 16;

  /// Keeps the mesh and builds its tree. Error when it has no triangle, an index is out of range, a position is not a
  /// number or Embree fails; use clean.h first.
  explicit Raycaster(Mesh m) : mesh_(std::move(m)), device_(rtcNewDevice(nullptr)) {
    require_usable(mesh_);
    const int vertices = int(mesh_.positions.size()), triangles = int(mesh_.triangles.size());
    check();
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry g = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* p = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                      std::size_t(vertices));
    void* i =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(int), std::size_t(triangles));
    check();
    for (int v = 0; v < vertices; ++v) {
      const float xyz[3] = {mesh_.positions[v].x, mesh_.positions[v].y, mesh_.positions[v].z};
      std::memcpy(static_cast<char*>(p) + std::size_t(v) * sizeof xyz, xyz, sizeof xyz);
    }
    std::memcpy(i, mesh_.triangles.data(), std::size_t(triangles) * 3 * sizeof(int));
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene_.get(), g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene_.get());
    check();
    box_ = bounds(mesh_);
  }

  const Mesh& mesh() const { return mesh_; }

  /// What the camera sees. samples x samples rays a pixel measure its coverage, at places that are spread evenly and
  /// are the same every time; a pixel that is hit at its centre as all its eight neighbours are counts as covered.
  /// samples = 1 looks at the centres only and is fastest.
  GBuffer trace(const Camera& camera, int samples = 4) const {
    if (camera.width <= 0 || camera.height <= 0)
      throw Error("camera of " + std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels");
    const int w = camera.width, h = camera.height, tiles = (w + 3) / 4, rows = (h + 3) / 4;
    std::vector<Hit> hits(std::size_t(w) * h);
    std::vector<int> first(h + 1);
    const std::vector<vec2<float>> places = spread_places(samples);
    const std::array<int, 4> frame = outline(camera);
    parallel_for(rows, [&](int row) {
      for (int column = 0; column < tiles; ++column) {
        const int x0 = column * 4, y0 = row * 4;
        if (x0 + 3 < frame[0] || x0 > frame[2] || y0 + 3 < frame[1] || y0 > frame[3]) continue;
        trace_tile(camera, x0, y0, hits.data());
      }
    });
    std::vector<std::uint8_t> inside(hits.size());
    if (!places.empty()) {
      parallel_for(h, [&](int y) {
        for (int x = 1; x + 1 < w && y > 0 && y + 1 < h; ++x) {
          bool all = true;
          for (int k = 0; k < 9 && all; ++k)
            all = hits[std::size_t(y + k / 3 - 1) * w + x + k % 3 - 1].triangle != none;
          inside[std::size_t(y) * w + x] = all;
        }
      });
    }
    parallel_for(h, [&](int y) {
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(y) * w + x;
        const bool seen = x >= frame[0] && x <= frame[2] && y >= frame[1] && y <= frame[3];
        if (!places.empty() && seen && !inside[i]) cover(camera, x, y, places, hits[i]);
        first[y + 1] += hits[i].triangle != none;
      }
    });
    for (int y = 0; y < h; ++y) first[y + 1] += first[y];
    GBuffer g;
    g.width = w, g.height = h, g.camera = camera, g.parts = mesh_.parts;
    g.resize(first[h]);
    parallel_for(h, [&](int y) {
      int i = first[y];
      for (int x = 0; x < w; ++x) {
        const Hit& hit = hits[std::size_t(y) * w + x];
        if (hit.triangle == none) continue;
        g.pixel[i] = y * w + x;
        write(g, i++, hit);
      }
    });
    g.close();
    return g;
  }

  /// For every pair of origin and unit direction: 1 if a ray meets the mesh before `reach` metres, else 0. The caller
  /// lifts origins off the surface (lift).
  void occluded(std::span<const vec3<float>> origins, std::span<const vec3<float>> directions,
                std::span<std::uint8_t> out, float reach = std::numeric_limits<float>::infinity()) const {
    if (origins.size() != directions.size() || out.size() != origins.size())
      throw Error("occluded: as many origins, directions and results expected");
    const int n = int(origins.size()), block = 256 * packet;
    parallel_for((n + block - 1) / block, [&](int b) {
      for (int i = b * block; i < std::min(n, (b + 1) * block); i += packet) {
        shadow_packet(std::min(packet, n - i), false, reach, out.data() + i, [&](int k) {
          return Ray{origins[i + k], directions[i + k]};
        });
      }
    });
  }

  /// What shines on a G-buffer: planes of visibility, one a direction (unit, from the surface to the light, infinitely
  /// far), each padded_size() long: out[d * padded_size() + i] is 1 where surfel i sees direction d, else 0. Behind its
  /// own face it sees nothing.
  std::vector<std::uint8_t> visible(const GBuffer& g, std::span<const vec3<float>> directions) const {
    const int n = g.size(), stride = g.padded_size(), block = 256;
    std::vector<std::uint8_t> out(std::size_t(stride) * directions.size());
    if (n == 0) return out;
    std::vector<vec3<float>> origins(n);
    for (int i = 0; i < n; ++i) origins[i] = lift(g.at(i).position, g.geometric_normal(i));
    parallel_for((n + block - 1) / block, [&](int b) {
      for (std::size_t d = 0; d < directions.size(); ++d) {
        std::uint8_t* const to = out.data() + d * stride;
        for (int i = b * block; i < std::min(n, (b + 1) * block); i += packet) {
          const int count = std::min(packet, n - i);
          shadow_packet(count, true, std::numeric_limits<float>::infinity(), to + i, [&](int k) {
            return Ray{origins[i + k], directions[d]};
          });
          for (int k = 0; k < count; ++k)
            to[i + k] = !to[i + k] && dot(g.geometric_normal(i + k), directions[d]) > 0;
        }
      }
    });
    for (std::size_t d = 0; d < directions.size(); ++d) {
      std::uint8_t* const to = out.data() + d * stride;
      std::fill(to + n, to + stride, to[n - 1]);
    }
    return out;
  }

  /// From surfel i of g: out[k] becomes 1 where unit direction k is blocked, by the mesh or because it lies behind the
  /// surfel's own face, else 0. What Illumination asks for; it may be called from many threads at once.
  void blocked(const GBuffer& g, int i, std::span<const vec3<float>> directions, std::span<std::uint8_t> out) const {
    const vec3<float> face = g.geometric_normal(i), from = lift(g.at(i).position, face);
    for (std::size_t d = 0; d < directions.size(); d += packet) {
      const int count = int(std::min(std::size_t(packet), directions.size() - d));
      shadow_packet(count, false, std::numeric_limits<float>::infinity(), out.data() + d, [&](int k) {
        return Ray{from, directions[d + std::size_t(k)]};
      });
    }
    for (std::size_t d = 0; d < directions.size(); ++d) out[d] = out[d] || dot(face, directions[d]) <= 0;
  }

  /// What the ray meets first. May be called from many threads at once, as blocked() may.
  SeenSurface first_hit(const Ray& ray) const {
    RTCRayHit r;
    r.ray = detail::one_ray(ray.origin, ray.direction, std::numeric_limits<float>::infinity());
    r.hit.geomID = none;
    detail::Query::intersect(scene_.get(), r);
    if (r.hit.geomID == none) return {};
    return surface_at(mesh_, int(r.hit.primID), r.hit.u, r.hit.v, ray.origin);
  }
  /// Whether the ray meets the mesh before `reach` metres.
  bool blocked(const Ray& ray, float reach = std::numeric_limits<float>::infinity()) const {
    RTCRay r = detail::one_ray(ray.origin, ray.direction, reach);
    detail::Query::occluded(scene_.get(), r);
    return r.tfar < 0;
  }

  /// A place off the surface along its unit geometric normal, where a ray may start and not meet the surface itself:
  /// the step is what a float can still tell apart, 1500 * 2^-24 of the coordinates (Mitsuba 3's ray epsilon).
  static vec3<float> lift(const vec3<float>& position, const vec3<float>& normal) {
    const float most = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
    return position + normal * ((1 + most) * 8.94e-5f);
  }

private:
  static constexpr unsigned none = RTC_INVALID_GEOMETRY_ID;
  struct Hit {
    unsigned triangle = none;
    float u = 0, v = 0, coverage = 0;
  };
  template <class T> using Handle = std::unique_ptr<std::remove_pointer_t<T>, detail::ReleaseEmbree>;

  Mesh mesh_;
  Handle<RTCDevice> device_;
  Handle<RTCScene> scene_;
  Box box_;

  void check() const {
    if (!device_) throw Error("Embree gives no device (error " + std::to_string(int(rtcGetDeviceError(nullptr))) + ")");
    const RTCError e = rtcGetDeviceError(device_.get());
    if (e != RTC_ERROR_NONE) throw Error("Embree fails on this mesh (error " + std::to_string(int(e)) + ")");
  }

  /// The pixels that may see the mesh: x from, y from, x to, y to; all where the box reaches behind the camera.
  std::array<int, 4> outline(const Camera& c) const {
    float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
    for (int k = 0; k < 8; ++k) {
      const vec3<float> p = c.project(
          {k & 1 ? box_.low.x : box_.high.x, k & 2 ? box_.low.y : box_.high.y, k & 4 ? box_.low.z : box_.high.z});
      if (!(p.z > 1e-4f)) return {0, 0, c.width - 1, c.height - 1};
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
    const auto clip = [](float x, int n) { return int(std::clamp(x, -2.0f, float(n) + 2)); };
    return {clip(x0, c.width) - 1, clip(y0, c.height) - 1, clip(x1, c.width) + 1, clip(y1, c.height) + 1};
  }

  /// Whether the rays ray(0) .. ray(n - 1) meet anything; n <= 16.
  template <class F> void shadow_packet(int n, bool coherent, float reach, std::uint8_t* out, F ray) const {
    RTCRay16 r;
    alignas(64) int valid[packet];
    for (int k = 0; k < packet; ++k) {
      const Ray a = ray(k < n ? k : 0);
      detail::set_ray(r, k, a.origin, a.direction, reach);
      valid[k] = k < n ? -1 : 0;
    }
    detail::Query::occluded(scene_.get(), valid, r, coherent);
    for (int k = 0; k < n; ++k) out[k] = r.tfar[k] < 0;
  }

  void trace_tile(const Camera& c, int x0, int y0, Hit* hits) const {
    RTCRayHit16 r;
    alignas(64) int valid[packet];
    for (int k = 0; k < packet; ++k) {
      const int x = x0 + k % 4, y = y0 + k / 4;
      valid[k] = x < c.width && y < c.height ? -1 : 0;
      detail::set_ray(r.ray, k, c.position, c.toward(float(x) + 0.5f, float(y) + 0.5f), std::numeric_limits<float>::infinity());
      r.hit.geomID[k] = none;
    }
    detail::Query::intersect(scene_.get(), valid, r, true);
    for (int k = 0; k < packet; ++k) {
      if (!valid[k]) continue;
      const int x = x0 + k % 4, y = y0 + k / 4;
      if (r.hit.geomID[k] != none) hits[std::size_t(y) * c.width + x] = {r.hit.primID[k], r.hit.u[k], r.hit.v[k], 1};
    }
  }
  /// Measures the pixel's coverage; where its centre missed, the hit becomes the covered place nearest to it.
  void cover(const Camera& c, int x, int y, const std::vector<vec2<float>>& places, Hit& hit) const {
    const int n = int(places.size());
    int covered = 0, nearest = -1;
    float best = 2;
    for (int i = 0; i < n; i += packet) {
      std::uint8_t met[packet];
      const int count = std::min(packet, n - i);
      shadow_packet(count, true, std::numeric_limits<float>::infinity(), met, [&](int k) {
        return Ray{c.position, c.toward(float(x) + places[i + k].x, float(y) + places[i + k].y)};
      });
      for (int k = 0; k < count; ++k) {
        if (!met[k]) continue;
        ++covered;
        const float dx = places[i + k].x - 0.5f, dy = places[i + k].y - 0.5f, d = dx * dx + dy * dy;
        if (d < best) best = d, nearest = i + k;
      }
    }
    if (hit.triangle == none && nearest >= 0) {
      RTCRayHit16 r;
      alignas(64) int valid[packet] = {-1};
      detail::set_ray(r.ray, 0, c.position, c.toward(float(x) + places[nearest].x, float(y) + places[nearest].y),
          std::numeric_limits<float>::infinity());
      r.hit.geomID[0] = none;
      detail::Query::intersect(scene_.get(), valid, r, true);
      if (r.hit.geomID[0] != none) hit = {r.hit.primID[0], r.hit.u[0], r.hit.v[0], 0};
    }
    if (hit.triangle != none) hit.coverage = float(std::max(covered, 1)) / float(n);
  }

  void write(GBuffer& g, int i, const Hit& hit) const {
    const SeenSurface seen = surface_at(mesh_, int(hit.triangle), hit.u, hit.v, g.camera.position);
    const Surfel<float>& s = seen.surfel;
    const auto put = [&](int at, const vec3<float>& x) {
      g.plane[at][i] = x.x, g.plane[at + 1][i] = x.y, g.plane[at + 2][i] = x.z;
    };
    put(0, s.position), put(3, s.normal), put(6, s.tangent), put(9, s.view);
    g.plane[12][i] = s.uv.x, g.plane[13][i] = s.uv.y;
    put(GBuffer::geometric, seen.face);
    g.plane[GBuffer::depth][i] = dot(s.position - g.camera.position, g.camera.forward);
    g.plane[GBuffer::coverage][i] = hit.coverage;
    g.part[i] = seen.part;
  }
};

}  // namespace burnish
