// burnish/io/bake.h -- a Surface, or a node that varies from place to place, as a glTF material
// SPDX-License-Identifier: Apache-2.0
//
// glTF's model (specification 2.0, appendix B, and its extensions) is not that of shade/brdf.h: its coat has the index
// 1.5 and takes light once, its diffuse base loses 1 - F(vh), a coat neither darkens nor roughens what is below it, and
// what is let through has the colour of the base. Metalness, indices and roughness (as seen through the coat) go over
// as they are, a coat of another index by its weight. The base's colour is chosen so that both reflect the same under an
// even sky, seen from all sides, by channel: left as it is, a coated paint would look a fifth brighter there.
//
// Lost are glints of flakes smaller than a texel, base_diffuse_roughness, a coat's own normal, and what a coat's index
// other than 1.5 does at grazing angles.
#pragma once
#include <burnish/ad/parallel.h>
#include <burnish/io/gltf.h>
#include <burnish/math/color.h>
#include <burnish/math/frame.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/shade/brdf.h>

namespace burnish {
namespace detail {

/// Reflectance under an even sky, meaned over views by their cosine; brdf_cos(v, l) about the normal z.
template <class F> vec3<double> mean_albedo(F brdf_cos_of) {
  constexpr int n = 24;
  vec3<double> sum;
  for (int i = 0; i < n * n * n; ++i) {
    const double c2 = (i / n / n + 0.5) / n, cl = (i / n % n + 0.5) / n, sl = std::sqrt(1 - cl * cl);
    const double azimuth = (i % n + 0.5) / n * double(pi);  // the other half is alike
    const vec3<float> v(float(std::sqrt(1 - c2)), 0, float(std::sqrt(c2)));
    const vec3<float> l(float(sl * std::cos(azimuth)), float(sl * std::sin(azimuth)), float(cl));
    sum += vec3<double>(brdf_cos_of(v, l));
  }
  return sum * (2 * double(pi) / (n * n * n));
}

/// glTF's reflection times the cosine about the normal z: appendix B, KHR_materials_clearcoat, _ior, _specular and
/// _transmission, alpha as coverage.
inline vec3<float> gltf_brdf_cos(const GltfMaterial& m, const vec3<float>& v, const vec3<float>& l) {
  const vec3<float> n(0, 0, 1), one(1), h = normalize(v + l);
  const float nl = std::max(l.z, 1e-4f), nv = std::max(v.z, 1e-4f), x = schlick_weight(dot(v, h));
  const auto lobe = [&](float r) { return ggx_d(r, n, h) * ggx_v_smith_correlated(r, nl, nv); };
  const vec3<float> d0 = min(m.specular_color * f0_from_ior(m.ior), one) * m.specular;
  const vec3<float> dielectric = d0 + (vec3<float>(m.specular) - d0) * x,
                    metal = m.base_color + (one - m.base_color) * x;
  const float left = (1 - std::max({dielectric.x, dielectric.y, dielectric.z})) * (1 - m.transmission);
  const vec3<float> base = (m.base_color * (inverse_pi * left) + dielectric * lobe(m.roughness)) * (1 - m.metalness) +
                           metal * (lobe(m.roughness) * m.metalness);
  const float coat = m.clearcoat * fresnel_schlick(dot(v, h), 0.04f) * lobe(m.clearcoat_roughness);
  return (base * (1 - m.clearcoat * fresnel_schlick(nv, 0.04f)) + vec3<float>(coat)) * (m.alpha * nl);
}
}  // namespace detail

struct BakeOptions {
  float tile = 0.5f;    ///< metres that the pictures repeat after
  float uv_metres = 1;  ///< metres a unit of uv, see fill_uvs
  int texels = 512;     ///< a side
  /// For viewers that know no transmission, glass is covered by its alpha only in part: so much of the light goes past
  /// it, less where the glass is darker than that. In those that do, both together let through what they should.
  float past_glass = 0.35f;
};

/// A surface that is the same everywhere; its geometry normals are not looked at.
inline GltfMaterial gltf_material(const std::string& name, const Surface<float>& s, const BakeOptions& o = {}) {
  Layers<float> a = layers(s);
  const vec3<float> n(0, 0, 1), one(1), through = transmittance(s, 1.0f);
  GltfMaterial m;
  m.name = name;
  m.metalness = std::clamp(s.base_metalness, 0.0f, 1.0f);
  m.roughness = std::clamp(a.base_roughness, 0.0f, 1.0f);
  m.ior = s.specular_ior, m.specular = std::clamp(s.specular_weight, 0.0f, 1.0f);
  m.clearcoat = std::clamp(a.coat_f0 / 0.04f, 0.0f, 1.0f);
  m.clearcoat_roughness = m.clearcoat > 0 ? std::clamp(a.coat_roughness, 0.0f, 1.0f) : 0;
  if (const float most = std::max({through.x, through.y, through.z}); most > 1e-3f) {
    const float past = std::min(o.past_glass, 0.8f * std::min({through.x, through.y, through.z}));
    m.alpha = 1 - past;
    // Both faces reflect; and only what is covered does.
    const float f0 = f0_from_ior(s.specular_ior), faces = mix(1.0f, 2 / (1 + f0 * m.specular), s.transmission_weight);
    m.specular_color = s.specular_color * (faces / m.alpha);
    const vec3<float> d0 = min(m.specular_color * f0, one) * m.specular;
    const vec3<float> crossing = (through - vec3<float>(past)) / ((1 - std::max({d0.x, d0.y, d0.z})) * m.alpha);
    const vec3<float> color =
        crossing + s.base_color * (s.base_weight * (1 - s.transmission_weight) * (1 - s.base_metalness) / m.alpha);
    m.base_color = min(color, one);
    m.transmission = std::clamp((crossing.x + crossing.y + crossing.z) / (color.x + color.y + color.z), 0.0f, 1.0f);
    return m;
  }
  // How much is reflected hardly depends on roughness; so sharp lobes are made wide enough to be summed.
  constexpr float least = 0.3f;
  GltfMaterial wide = m;
  a.base_roughness = wide.roughness = std::max(m.roughness, least);
  a.coat_roughness = wide.clearcoat_roughness = std::max(m.clearcoat_roughness, least);
  const auto ours = [&](const Layers<float>& x) {
    return detail::mean_albedo([&](auto& v, auto& l) { return brdf_cos(x, n, n, v, l); });
  };
  const auto theirs = [&](const GltfMaterial& x) {
    return detail::mean_albedo([&](auto& v, auto& l) { return detail::gltf_brdf_cos(x, v, l); });
  };
  // The dielectric's shine alone, then all; each is linear in what is looked for.
  Layers<float> shine = a;
  Surface<float> dielectric = s;
  dielectric.base_metalness = 0;
  {
    const Layers<float> d = layers(dielectric);
    shine.base_f0 = d.base_f0, shine.base_f90 = d.base_f90, shine.diffuse = {};
  }
  const float tint = std::max({shine.base_f90.x, shine.base_f90.y, shine.base_f90.z, 1e-6f});
  m.specular_color = wide.specular_color = shine.base_f0 / (tint * f0_from_ior(s.specular_ior));
  wide.metalness = 0, wide.base_color = {};
  const auto by_specular = [&](float x) {
    wide.specular = x;
    return luminance(theirs(wide));
  };
  const double dull = by_specular(0);
  m.specular = wide.specular = std::clamp(float((luminance(ours(shine)) - dull) / (by_specular(1) - dull)), 0.0f, 1.0f);
  wide.metalness = m.metalness;
  const vec3<double> dark = theirs(wide);
  wide.base_color = one;
  m.base_color = min(max(vec3<float>((ours(a) - dark) / (theirs(wide) - dark)), vec3<float>(0)), one);
  return m;
}

/// A node, or any model(at) that gives a Surface, laid out on a plane through its own frame: `tile` metres square,
/// made to repeat without a seam by blending a sixth of it with what lies beyond, its mean and variance kept (Heitz and
/// Neyret 2018, section 3.2). Only what varies becomes a picture.
template <class Model> GltfMaterial bake(const std::string& name, const Model& model, const BakeOptions& o = {}) {
  constexpr std::size_t channels = 8;  // base color, roughness, metalness, normal
  const int n = std::max(o.texels, 6), border = n / 6, side = n + border;
  std::vector<std::array<float, channels>> wide(std::size_t(side) * std::size_t(side)),
      out(std::size_t(n) * std::size_t(n));
  Surface<float> middle;
  const Frame<float> plane =
      frame_of(vec3<float>(0.48f, 0.64f, 0.6f));  // oblique: a lattice's own planes are not typical
  parallel_for(side, [&](int y) {
    for (int x = 0; x < side; ++x) {
      const vec2<float> uv(o.tile * (float(x) + 0.5f) / float(n), o.tile * (float(y) + 0.5f) / float(n));
      const Surfel<float> at{plane.t * uv.x + plane.b * uv.y, plane.n, plane.t, plane.n, uv, 0};
      const Surface<float> s = model(at);
      const vec3<float> c = s.base_color * s.base_weight, b = s.geometry_normal;
      wide[std::size_t(y) * std::size_t(side) + std::size_t(x)] = {
          c.x, c.y, c.z, layers(s).base_roughness, s.base_metalness, b.x, b.y, b.z};
      if (x == 0 && y == 0) middle = s;
    }
  });
  std::array<double, channels> mean{};
  std::array<float, channels> low = wide[0], high = wide[0];
  for (const auto& texel : wide)
    for (std::size_t c = 0; c < channels; ++c)
      mean[c] += double(texel[c]) / double(wide.size()), low[c] = std::min(low[c], texel[c]),
                                                         high[c] = std::max(high[c], texel[c]);
  const auto varies = [&](std::size_t from, std::size_t count) {
    bool any = false;
    for (std::size_t c = from; c < from + count; ++c) any |= high[c] - low[c] > 1.0f / 512;
    return any;
  };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto share = [&](int i) { return i < border ? (float(i) + 0.5f) / float(border) : 1.0f; };
      const float u = share(x), v = share(y);
      const float w[4] = {u * v, (1 - u) * v, u * (1 - v), (1 - u) * (1 - v)};
      const float norm = 1 / std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
      for (std::size_t c = 0; c < channels; ++c) {
        float sum = 0;
        for (int k = 0; k < 4; ++k) {
          const int i = std::min(x + (k & 1) * n, side - 1), j = std::min(y + (k >> 1) * n, side - 1);
          sum += w[k] * (wide[std::size_t(j) * std::size_t(side) + std::size_t(i)][c] - float(mean[c]));
        }
        out[std::size_t(y) * std::size_t(n) + std::size_t(x)][c] = float(mean[c]) + sum * norm;
      }
    }

  const auto mean3 = vec3<float>(float(mean[0]), float(mean[1]), float(mean[2]));
  middle.base_color = mean3, middle.base_weight = 1, middle.base_metalness = float(mean[4]);
  GltfMaterial m = gltf_material(name, middle, o);
  m.roughness = std::clamp(float(mean[3]), 0.0f, 1.0f);
  m.tiles = vec2<float>(o.uv_metres / o.tile, o.uv_metres / o.tile);
  const auto picture = [&](auto color) {
    Image image(n, n);
    for (int i = 0; i < n * n; ++i)  // the first row at the larger v
      image.set(i % n, n - 1 - i / n, color(out[std::size_t(i)]));
    return image;
  };
  if (varies(0, 3)) {
    const vec3<float> most(high[0], high[1], high[2]), ratio = m.base_color / max(mean3, vec3<float>(1e-6f));
    const vec3<float> factor = min(most * ratio, vec3<float>(1)), over = ratio / max(factor, vec3<float>(1e-6f));
    m.base_color_map = picture([&](const auto& t) { return vec3<float>(t[0], t[1], t[2]) * over; });
    m.base_color = factor;
  }
  if (varies(3, 2)) {
    m.roughness_metalness_map = picture([](const auto& t) { return vec3<float>(1, t[3], t[4]); });
    m.roughness = m.metalness = 1;
  }
  if (varies(5, 3))
    m.normal_map = picture([](const auto& t) { return normalize(vec3<float>(t[5], t[6], std::max(t[7], 0.05f))); });
  return m;
}

}  // namespace burnish
