// burnish/fit/planes.h -- a struct for every pixel, stored as a plane for every number of it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <burnish/ad/replay.h>
#include <burnish/scene/gbuffer.h>

namespace burnish {

/// count structs P, one plane a number in the order of each(); planes are padded to whole tiles with the last struct's
/// values. As the pixels of a look it is what the look reads; as its model, a model for every pixel, and the derivative
/// by it is one again.
template <template <class> class P> struct Planes {
  static constexpr int fields = burnish::count<P<float>>();
  std::array<Floats, std::size_t(fields)> plane;

  explicit Planes(int n = 0, const P<float>& value = {}) : length(n) {
    static_assert(!detail::has_fixed_members<P<float>>(),
                  "burnish: planes hold numbers only; what is Fixed goes into data");
    std::size_t k = 0;
    each([&](float x) { plane[k++].assign(padded(std::size_t(n), tile), x); }, value);
  }
  int size() const { return length; }
  P<float> at(int i) const {
    P<float> p;
    std::size_t k = 0;
    each([&](float& x) { x = plane[k++][std::size_t(i)]; }, p);
    return p;
  }
  void set(int i, const P<float>& p) {
    const std::size_t from = std::size_t(i), to = i == length - 1 ? plane[0].size() : from + 1;
    std::size_t k = 0;
    each(
        [&](float x) {
          std::fill(plane[k].begin() + std::ptrdiff_t(from), plane[k].begin() + std::ptrdiff_t(to), x), ++k;
        },
        p);
  }
  std::array<const float*, std::size_t(fields)> pointers() const {
    std::array<const float*, std::size_t(fields)> p;
    for (std::size_t k = 0; k < std::size_t(fields); ++k) p[k] = plane[k].data();
    return p;
  }

private:
  int length = 0;
};

namespace detail {
/// What a source of pixels holds in each of them.
template <class G> struct pixels_of;
template <> struct pixels_of<GBuffer> {
  template <class T> using type = Surfel<T>;
};
template <template <class> class P> struct pixels_of<Planes<P>> {
  template <class T> using type = P<T>;
};
template <class M> inline constexpr bool is_planes = false;
template <template <class> class P> inline constexpr bool is_planes<Planes<P>> = true;

/// The model one pixel sees: itself, or one of the planes'.
template <class M> struct model_at {
  using type = M;
};
template <template <class> class P> struct model_at<Planes<P>> {
  using type = P<float>;
};
}  // namespace detail

}  // namespace burnish
