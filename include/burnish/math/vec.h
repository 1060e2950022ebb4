// burnish/math/vec.h -- small vectors over any number
// SPDX-License-Identifier: Apache-2.0
//
// Each takes any foreign vector with .x .y .z (GLM's, Eigen's through its accessors, a host renderer's own), so that a
// host can hand its vectors over as they are.
#pragma once
#include <burnish/ad/model.h>

namespace burnish {

namespace detail {
/// v.x or v.x(): a foreign vector's component.
#define BURNISH_COMPONENT(c)                                        \
  template <class V> constexpr decltype(auto) component_##c(const V& v) { \
    if constexpr (requires { v.c(); }) return v.c();                \
    else return (v.c);                                              \
  }
BURNISH_COMPONENT(x)
BURNISH_COMPONENT(y)
BURNISH_COMPONENT(z)
BURNISH_COMPONENT(w)
#undef BURNISH_COMPONENT
template <class V> concept Foreign2 = requires(const V& v) { v.x; v.y; } || requires(const V& v) { v.x(); v.y(); };
template <class V> concept Foreign3 = Foreign2<V> && (requires(const V& v) { v.z; } || requires(const V& v) { v.z(); });
template <class V> concept Foreign4 = Foreign3<V> && (requires(const V& v) { v.w; } || requires(const V& v) { v.w(); });
}  // namespace detail

template <class T> struct vec2 {
  T x{}, y{};
  constexpr vec2() = default;
  constexpr vec2(const T& a, const T& b) : x(a), y(b) {}
  explicit constexpr vec2(const T& s) : x(s), y(s) {}
  template <detail::Foreign2 V> constexpr vec2(const V& v)
      : x(T(detail::component_x(v))), y(T(detail::component_y(v))) {}
  static constexpr auto parameters() { return std::tuple{Param{"x", &vec2::x}, Param{"y", &vec2::y}}; }

  friend constexpr vec2 operator+(const vec2& a, const vec2& b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr vec2 operator-(const vec2& a, const vec2& b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr vec2 operator*(const vec2& a, const vec2& b) { return {a.x * b.x, a.y * b.y}; }
  friend constexpr vec2 operator/(const vec2& a, const vec2& b) { return {a.x / b.x, a.y / b.y}; }
  friend constexpr vec2 operator*(const vec2& a, const T& s) { return {a.x * s, a.y * s}; }
  friend constexpr vec2 operator*(const T& s, const vec2& a) { return {a.x * s, a.y * s}; }
  friend constexpr vec2 operator/(const vec2& a, const T& s) { return a * (T(1.0f) / s); }
  friend constexpr vec2 operator-(const vec2& a) { return {-a.x, -a.y}; }
  friend constexpr vec2& operator+=(vec2& a, const vec2& b) { return a = a + b; }
  friend constexpr vec2& operator-=(vec2& a, const vec2& b) { return a = a - b; }
  friend constexpr vec2& operator*=(vec2& a, const T& s) { return a = a * s; }
  friend constexpr T dot(const vec2& a, const vec2& b) { return a.x * b.x + a.y * b.y; }
  friend constexpr T length(const vec2& a) { return sqrt(dot(a, a)); }
  friend constexpr vec2 normalize(const vec2& a) { return a * rsqrt(max(dot(a, a), 1e-24f)); }
  friend constexpr vec2 mix(const vec2& a, const vec2& b, const T& t) { return a + (b - a) * t; }
};

template <class T> struct vec3 {
  T x{}, y{}, z{};
  constexpr vec3() = default;
  constexpr vec3(const T& a, const T& b, const T& c) : x(a), y(b), z(c) {}
  explicit constexpr vec3(const T& s) : x(s), y(s), z(s) {}
  template <detail::Foreign3 V> constexpr vec3(const V& v)
      : x(T(detail::component_x(v))), y(T(detail::component_y(v))), z(T(detail::component_z(v))) {}
  static constexpr auto parameters() {
    return std::tuple{Param{"x", &vec3::x}, Param{"y", &vec3::y}, Param{"z", &vec3::z}};
  }

  friend constexpr vec3 operator+(const vec3& a, const vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr vec3 operator-(const vec3& a, const vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr vec3 operator*(const vec3& a, const vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend constexpr vec3 operator/(const vec3& a, const vec3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
  friend constexpr vec3 operator*(const vec3& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr vec3 operator*(const T& s, const vec3& a) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr vec3 operator/(const vec3& a, const T& s) { return a * (T(1.0f) / s); }
  friend constexpr vec3 operator-(const vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr vec3& operator+=(vec3& a, const vec3& b) { return a = a + b; }
  friend constexpr vec3& operator-=(vec3& a, const vec3& b) { return a = a - b; }
  friend constexpr vec3& operator*=(vec3& a, const vec3& b) { return a = a * b; }
  friend constexpr vec3& operator*=(vec3& a, const T& s) { return a = a * s; }
  friend constexpr T dot(const vec3& a, const vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend constexpr vec3 cross(const vec3& a, const vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend constexpr T length(const vec3& a) { return sqrt(dot(a, a)); }
  /// The zero vector stays as it is: within 1e-12 of it this is 1e12 a, in value and slope.
  friend constexpr vec3 normalize(const vec3& a) { return a * rsqrt(max(dot(a, a), 1e-24f)); }
  friend constexpr vec3 mix(const vec3& a, const vec3& b, const T& t) { return a + (b - a) * t; }
  friend constexpr vec3 mix(const vec3& a, const vec3& b, const vec3& t) { return a + (b - a) * t; }
  friend constexpr vec3 min(const vec3& a, const vec3& b) { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
  friend constexpr vec3 max(const vec3& a, const vec3& b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
  friend constexpr vec3 clamp(const vec3& a, const T& low, const T& high) {
    return {min(max(a.x, low), high), min(max(a.y, low), high), min(max(a.z, low), high)};
  }
};

template <class T> struct vec4 {
  T x{}, y{}, z{}, w{};
  constexpr vec4() = default;
  constexpr vec4(const T& a, const T& b, const T& c, const T& d) : x(a), y(b), z(c), w(d) {}
  explicit constexpr vec4(const T& s) : x(s), y(s), z(s), w(s) {}
  constexpr vec4(const vec3<T>& v, const T& d) : x(v.x), y(v.y), z(v.z), w(d) {}
  template <detail::Foreign4 V> constexpr vec4(const V& v)
      : x(T(detail::component_x(v))), y(T(detail::component_y(v))), z(T(detail::component_z(v))),
        w(T(detail::component_w(v))) {}
  static constexpr auto parameters() {
    return std::tuple{Param{"x", &vec4::x}, Param{"y", &vec4::y}, Param{"z", &vec4::z}, Param{"w", &vec4::w}};
  }

  friend constexpr vec4 operator+(const vec4& a, const vec4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
  friend constexpr vec4 operator-(const vec4& a, const vec4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
  friend constexpr vec4 operator*(const vec4& a, const T& s) { return {a.x * s, a.y * s, a.z * s, a.w * s}; }
  friend constexpr vec4 operator*(const T& s, const vec4& a) { return a * s; }
  friend constexpr T dot(const vec4& a, const vec4& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
  friend constexpr vec4 mix(const vec4& a, const vec4& b, const T& t) { return a + (b - a) * t; }
};

}  // namespace burnish
