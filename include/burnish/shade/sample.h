// burnish/shade/sample.h -- directions drawn where a Surface reflects much, for path tracing
// SPDX-License-Identifier: Apache-2.0
//
// One of three lobes is chosen by about what it reflects: coat and base by visible normals (Heitz 2018), the diffuse
// base by the cosine (Malley). What they miss of each other's is made good by dividing by the density of all three.
// Both layers around one normal. Floats; not differentiable.
#pragma once
#include <algorithm>
#include <cmath>
#include <burnish/math/frame.h>
#include <burnish/shade/brdf.h>

namespace burnish {

/// Chances of the three lobes for one view; nv > 0.
struct LobeChances {
  float coat = 0, base = 0, diffuse = 1;
};
inline LobeChances lobe_chances(const Layers<float>& s, float nv) {
  const auto grey = [](const vec3<float>& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; };
  const float coat = std::clamp(fresnel_schlick(nv, s.coat_f0, s.coat_f90), 0.0f, 1.0f), through = 1 - coat;
  const float base = through * grey(fresnel_schlick(nv, s.base_f0, s.base_f90));
  const float diffuse = through * through * grey(s.diffuse * s.albedo * s.dielectric_passes(nv));
  const float sum = coat + base + diffuse;
  if (!(sum > 1e-6f)) return {};
  return {coat / sum, base / sum, diffuse / sum};
}

/// The density, per steradian, with which sample_brdf gives l; n, v, l unit, n.v > 0.
inline float brdf_density(const Layers<float>& s, const LobeChances& p, const vec3<float>& n, const vec3<float>& v,
                          const vec3<float>& l) {
  const float nl = dot(n, l), nv = std::max(dot(n, v), 1e-4f);
  if (nl <= 0) return 0;
  const vec3<float> h = normalize(v + l);
  const float vh = std::max(dot(v, h), 1e-6f);
  const auto lobe = [&](float roughness) {
    return ggx_visible_normal_pdf(roughness, nv, vh, ggx_d(roughness, n, h)) / (4 * vh);
  };
  return p.coat * (p.coat > 0 ? lobe(s.coat_roughness) : 0) + p.base * (p.base > 0 ? lobe(s.base_roughness) : 0) +
         p.diffuse * nl * inverse_pi;
}
/// A direction to the light, from u in [0, 1)^3; it may lie below the surface, where brdf_density is 0.
inline vec3<float> sample_brdf(const Layers<float>& s, const LobeChances& p, const vec3<float>& n, const vec3<float>& v,
                               const vec3<float>& u) {
  const Frame<float> frame = frame_of(n);
  if (u.z >= p.coat + p.base) {
    const float r = std::sqrt(u.x), phi = 2 * pi * u.y;
    return normalize(frame.to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1 - u.x, 1e-7f))}));
  }
  vec3<float> local = frame.to_local(v);
  local.z = std::max(local.z, 1e-4f);
  const float roughness = u.z < p.coat ? s.coat_roughness : s.base_roughness;
  const vec3<float> h = frame.to_world(ggx_sample_visible_normal(roughness, local, vec2<float>(u.x, u.y)));
  return normalize(reflect(v, h));
}

}  // namespace burnish
