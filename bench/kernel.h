// bench/kernel.h -- the kernel that gradients are timed on, as a user would write it, and its adjoint written by hand
// SPDX-License-Identifier: Apache-2.0
//
// Per pixel 8 differentiable numbers (base colour, roughness, metalness, a normal that is normalised inside), a view
// direction and a target; directional lights shared by all pixels. GGX with alpha = roughness^2, height-correlated Smith,
// Schlick with F0 = mix(0.04, base colour, metalness), Lambert times (1 - metalness)(1 - F); loss = squared difference to
// the target. Asked for: the sum of the losses and all 8 derivatives of every pixel.
#pragma once
#include <burnish/fit/render.h>

namespace kernel {
using namespace burnish;

template <class T> struct Paint {
  vec3<T> base_color;
  T roughness{}, metalness{};
  vec3<T> normal;
  static constexpr auto parameters() {
    return std::tuple{Param{"base_color", &Paint::base_color, unit}, Param{"roughness", &Paint::roughness, unit},
                      Param{"metalness", &Paint::metalness, unit}, Param{"normal", &Paint::normal}};
  }
};
template <class T> struct Pixel {
  vec3<T> view, target;
  static constexpr auto parameters() {
    return std::tuple{Param{"view", &Pixel::view}, Param{"target", &Pixel::target}};
  }
};
template <class T> struct Light {
  vec3<T> direction, radiance;  // direction: unit, to the light
  static constexpr auto parameters() {
    return std::tuple{Param{"direction", &Light::direction}, Param{"radiance", &Light::radiance}};
  }
};

/// f_r * nl * radiance of one light.
template <class T>
constexpr vec3<T> reflected(const Paint<T>& p, const vec3<T>& n, const vec3<T>& v, const Light<T>& light) {
  const vec3<T> l = light.direction, h = normalize(v + l), white(T(1.0f));
  const T nl = max(dot(n, l), 0), nv = max(dot(n, v), 1e-4f), nh = max(dot(n, h), 0), vh = max(dot(v, h), 0);
  const T a2 = p.roughness * p.roughness * p.roughness * p.roughness, b2 = 1.0f - a2, k = 1.0f - nh * nh * b2;
  const T d = a2 * inverse_pi / (k * k);
  const T g = 0.5f / (nl * sqrt(nv * nv * b2 + a2) + nv * sqrt(nl * nl * b2 + a2));
  const T m = 1.0f - vh, m2 = m * m, curve = m2 * m2 * m;
  const vec3<T> f0 = mix(vec3<T>(T(0.04f)), p.base_color, p.metalness), f = f0 * (1.0f - curve) + vec3<T>(curve);
  const vec3<T> diffuse = p.base_color * ((1.0f - p.metalness) * inverse_pi);
  return (diffuse * (white - f) + f * (d * g)) * light.radiance * nl;
}
template <class T> constexpr T squared_error(const vec3<T>& color, const vec3<T>& target) {
  const vec3<T> e = color - target;
  return dot(e, e);
}
/// With a list of any length: one loop node.
inline constexpr auto loss_over_list = [](const auto& paint, const auto& pixel, const auto& lights) {
  const auto n = normalize(paint.normal);
  return squared_error(repeat(lights, [&](const auto& light) { return reflected(paint, n, pixel.view, light); }),
                       pixel.target);
};
/// With an array: unrolled.
inline constexpr auto loss_over_array = [](const auto& paint, const auto& pixel, const auto& lights) {
  const auto n = normalize(paint.normal);
  auto sum = reflected(paint, n, pixel.view, lights[0]);
  for (std::size_t i = 1; i < lights.size(); ++i) sum = sum + reflected(paint, n, pixel.view, lights[i]);
  return squared_error(sum, pixel.target);
};

/// The adjoint by hand, for any T that is float-like: writes the 8 derivatives and gives the loss.
/// in: base colour, roughness, metalness, normal. Lights as {direction, radiance}.
template <class T, int MaxLights> [[gnu::always_inline]] inline T by_hand(const T* in, const vec3<T>& v,
                                                                          const vec3<T>& target,
                                                                          const Light<float>* lights, int count, T* g) {
  struct Saved {
    T nl, nh, inverse_k, gl, dg, vis, d, curve, rest, hx, hy, hz;
  };
  const T inverse = rsqrt(in[5] * in[5] + in[6] * in[6] + in[7] * in[7]);
  const T nx = in[5] * inverse, ny = in[6] * inverse, nz = in[7] * inverse;
  const T alpha = in[3] * in[3], a2 = alpha * alpha, b2 = 1.0f - a2, opaque = 1.0f - in[4];
  const T a2_pi = a2 * inverse_pi, weight = opaque * inverse_pi;
  T f0[3], diffuse[3];
  for (int c = 0; c < 3; ++c) f0[c] = 0.04f * opaque + in[c] * in[4], diffuse[c] = in[c] * weight;
  const T nv_raw = nx * v.x + ny * v.y + nz * v.z, nv = max(nv_raw, T(1e-4f)), gv = sqrt(nv * nv * b2 + a2);
  T rgb[3] = {0.0f, 0.0f, 0.0f};
  Saved saved[MaxLights];
#pragma GCC unroll 1
  for (int i = 0; i < count; ++i) {
    const auto& l = lights[i];
    Saved& s = saved[i];
    T hx = v.x + l.direction.x, hy = v.y + l.direction.y, hz = v.z + l.direction.z;
    const T ih = rsqrt(hx * hx + hy * hy + hz * hz);
    s.hx = hx * ih, s.hy = hy * ih, s.hz = hz * ih;
    const T m = 1.0f - max(v.x * s.hx + v.y * s.hy + v.z * s.hz, T(0.0f)), m2 = m * m;
    s.curve = m2 * m2 * m, s.rest = 1.0f - s.curve;
    s.nl = max(nx * l.direction.x + ny * l.direction.y + nz * l.direction.z, T(0.0f));
    s.nh = max(nx * s.hx + ny * s.hy + nz * s.hz, T(0.0f));
    s.inverse_k = 1.0f / (1.0f - s.nh * s.nh * b2);
    s.d = a2_pi * s.inverse_k * s.inverse_k;
    s.gl = sqrt(s.nl * s.nl * b2 + a2);
    s.vis = 0.5f / (s.nl * gv + nv * s.gl);
    s.dg = s.d * s.vis;
    const float radiance[3] = {l.radiance.x, l.radiance.y, l.radiance.z};
    for (int c = 0; c < 3; ++c) {
      const T f = f0[c] * s.rest + s.curve;
      rgb[c] += (diffuse[c] * (1.0f - f) + s.dg * f) * (s.nl * radiance[c]);
    }
  }
  const T e[3] = {rgb[0] - target.x, rgb[1] - target.y, rgb[2] - target.z};
  const T loss = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  T d_rgb[3], d_diffuse[3], d_f0[3];
  for (int c = 0; c < 3; ++c) d_rgb[c] = 2.0f * e[c], d_diffuse[c] = T(0.0f), d_f0[c] = T(0.0f);
  T d_nx = 0.0f, d_ny = 0.0f, d_nz = 0.0f, d_gv = 0.0f, d_nv = 0.0f, d_b2 = 0.0f, d_a2 = 0.0f, d_a2_pi = 0.0f;
#pragma GCC unroll 1
  for (int i = 0; i < count; ++i) {
    const auto& l = lights[i];
    const Saved& s = saved[i];
    const float radiance[3] = {l.radiance.x, l.radiance.y, l.radiance.z};
    T d_dg = 0.0f, d_nl = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const T f = f0[c] * s.rest + s.curve, miss = 1.0f - f, w = d_rgb[c] * radiance[c], o = w * s.nl;
      d_nl += w * (diffuse[c] * miss + s.dg * f);
      d_diffuse[c] += o * miss;
      d_dg += o * f;
      d_f0[c] += o * (s.dg - diffuse[c]) * s.rest;
    }
    const T d_d = d_dg * s.vis, q = -2.0f * (d_dg * s.dg * s.vis), t = q * nv * 0.5f / s.gl;
    d_nl += q * gv + 2.0f * t * s.nl * b2;
    d_gv += q * s.nl, d_nv += q * s.gl;
    d_b2 += t * s.nl * s.nl, d_a2 += t;
    d_a2_pi += d_d * s.inverse_k * s.inverse_k;
    const T d_k = -2.0f * d_d * s.d * s.inverse_k, d_nh = -2.0f * d_k * s.nh * b2;
    d_b2 -= d_k * s.nh * s.nh;
    d_nl = select(s.nl > 0.0f, d_nl, T(0.0f));
    d_nx += d_nl * l.direction.x + d_nh * s.hx;
    d_ny += d_nl * l.direction.y + d_nh * s.hy;
    d_nz += d_nl * l.direction.z + d_nh * s.hz;
  }
  const T t = d_gv * 0.5f / gv;
  d_nv += 2.0f * t * nv * b2, d_b2 += t * nv * nv, d_a2 += t;
  d_nv = select(nv_raw > 1e-4f, d_nv, T(0.0f));
  d_nx += d_nv * v.x, d_ny += d_nv * v.y, d_nz += d_nv * v.z;
  T d_weight = 0.0f, d_opaque = 0.0f, d_metal = 0.0f;
  for (int c = 0; c < 3; ++c) {
    g[c] = d_f0[c] * in[4] + d_diffuse[c] * weight;
    d_metal += d_f0[c] * in[c], d_opaque += 0.04f * d_f0[c], d_weight += d_diffuse[c] * in[c];
  }
  d_opaque += d_weight * inverse_pi;
  g[4] = d_metal - d_opaque;
  d_a2 += d_a2_pi * inverse_pi - d_b2;
  g[3] = d_a2 * 4.0f * alpha * in[3];
  const T along = nx * d_nx + ny * d_ny + nz * d_nz;
  g[5] = inverse * (d_nx - nx * along), g[6] = inverse * (d_ny - ny * along), g[7] = inverse * (d_nz - nz * along);
  return loss;
}

/// The scene: random paint, views of a camera above a square, lights from above.
struct Scene {
  Planes<Paint> paint;
  Planes<Pixel> pixels;
  std::vector<Light<float>> lights;

  Scene(int width, int height, int count) : paint(width * height), pixels(width * height) {
    unsigned seed = 12345;
    const auto random = [&] {
      seed = seed * 1664525u + 1013904223u;
      return float(seed >> 8) * (1.0f / 16777216.0f);
    };
    for (int i = 0; i < count; ++i) {
      vec3<float> d;
      do d = {2 * random() - 1, 2 * random() - 1, 1.6f * random() - 0.3f};
      while (dot(d, d) > 1 || dot(d, d) < 0.01f);
      lights.push_back(
          {normalize(d), vec3<float>{0.3f + 1.2f * random(), 0.3f + 1.2f * random(), 0.3f + 1.2f * random()} *
                             (8.0f / float(count))});
    }
    for (int i = 0; i < width * height; ++i) {
      const float u = (float(i % width) + 0.5f) / float(width) * 2 - 1,
                  w = (float(i / width) + 0.5f) / float(height) * 2 - 1;
      const vec3<float> v = normalize(vec3<float>{-0.5f * u, -0.5f * w, 1.0f});
      const float s = 0.8f + 0.5f * random();
      const vec3<float> tilt{random() - 0.5f, random() - 0.5f, 0.4f * (random() - 0.5f)};
      paint.set(i, {{0.05f + 0.9f * random(), 0.05f + 0.9f * random(), 0.05f + 0.9f * random()},
                    0.25f + 0.74f * random(),
                    0.02f + 0.96f * random(),
                    (v + tilt) * s});
      pixels.set(i, {v, {2 * random(), 2 * random(), 2 * random()}});
    }
  }
};

}  // namespace kernel
