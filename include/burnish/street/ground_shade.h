// burnish/street/ground_shade.h -- a vehicle's shadow on the ground, on a grid, as the vehicle mirrors it
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <vector>
#include <burnish/ad/parallel.h>
#include <burnish/math/sequence.h>
#include <burnish/scene/mesh.h>

namespace burnish {

/// What light the ground gets, by what it gets without the vehicle. One draw's numbers mean little: of the sums of
/// many, seen / all is the shadow, without noise where all is seen or nothing is (a ratio estimator: consistent, its
/// bias falls as one by the number of draws).
struct GroundLight {
  vec3<float> seen, all;  ///< past the vehicle; all of it: 1 in the mean
  vec3<float> thrown;     ///< by the vehicle, back on the ground

  /// seen / all; 1 where no light comes from above.
  vec3<float> shadow() const {
    const auto share = [](float some, float of) { return of > 0 ? some / of : 1; };
    return {share(seen.x, all.x), share(seen.y, all.y), share(seen.z, all.z)};
  }
};
/// Shadows about a vehicle, some centimetres from one to the next: sharp enough for paint that mirrors them, and one look
/// instead of two rays. Beyond, there is none.
class GroundShade {
public:
  GroundShade() = default;
  /// box: the vehicle's. draw(place, random): a GroundLight.
  template <class Draw> GroundShade(const Box& box, float height, int draws, Draw draw, std::uint32_t seed) {
    const float reach = 1.5f * (box.high.y - height);
    if (!(reach > 0)) return;
    from_ = {box.low.x - reach, box.low.z - reach};
    const vec2<float> size(box.high.x + reach - from_.x, box.high.z + reach - from_.y);
    step_ = std::max(size.x, size.y) / 99;
    width_ = int(size.x / step_) + 2, height_ = int(size.y / step_) + 2;
    values_.resize(std::size_t(width_) * std::size_t(height_));
    parallel_for(height_, [&](int j) {
      for (int i = 0; i < width_; ++i) {
        const std::size_t at = std::size_t(j) * std::size_t(width_) + std::size_t(i);
        const vec3<float> place(from_.x + float(i) * step_, height, from_.y + float(j) * step_);
        GroundLight sum;
        for (int k = 0; k < draws; ++k) {
          PathNumbers random(std::uint32_t(at), std::uint32_t(k), seed);
          const GroundLight g = draw(place, random);
          sum.seen += g.seen, sum.all += g.all;
        }
        values_[at] = sum.shadow();
      }
    });
  }
  vec3<float> operator()(const vec3<float>& place) const {
    const float x = (place.x - from_.x) / step_, y = (place.z - from_.y) / step_;
    if (values_.empty() || !(x >= 0 && y >= 0 && x < float(width_ - 1) && y < float(height_ - 1)))
      return vec3<float>(1.0f);
    const int i = int(x), j = int(y);
    const vec3<float>* const at = &values_[std::size_t(j) * std::size_t(width_) + std::size_t(i)];
    const float u = x - float(i), v = y - float(j);
    return mix(mix(at[0], at[1], u), mix(at[width_], at[width_ + 1], u), v);
  }

private:
  std::vector<vec3<float>> values_;
  vec2<float> from_;
  float step_ = 1;
  int width_ = 0, height_ = 0;
};

}  // namespace burnish
