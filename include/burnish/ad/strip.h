// burnish/ad/strip.h -- one operation over a strip of pixels, forth and back: the steps of the replay
// SPDX-License-Identifier: Apache-2.0
//
// A step reads its operands' places first and then runs over the strip; short operations are unrolled, and those back
// are compiled once for every way their adjoints may go.
#pragma once
#include <burnish/ad/environment.h>

namespace burnish {

namespace detail {

/// Pixels that one operation of the replay does at a time.
inline constexpr int strip = 128;

/// One operation over a strip. Operands are offsets in floats, multiples of 16; their lowest bits say what they mean.
struct Step {
  static constexpr int inlined = 6;  // so many operands lie here; of longer lists the place in `more`
  Run* run = nullptr;
  int at[inlined] = {};
};
enum Operand : int {
  uniform = 1,
  framed = 2,  // values: one packet for all; in the frame of the turn
  none = 0,
  assigned = 1,
  added = 2,
  summed = 3,
  absent = 1  // adjoints: summed into one packet; absent: there is none
};
constexpr int offset(int at) { return at & ~15; }

/// Operations of few instructions, whose loops over a strip are worth unrolling.
template <class Op> inline constexpr bool brief = false;
#define BURNISH_BRIEF(name) template <> inline constexpr bool brief<op::name> = true;
BURNISH_BRIEF(Add)
BURNISH_BRIEF(Sub) BURNISH_BRIEF(Mul) BURNISH_BRIEF(MulAdd) BURNISH_BRIEF(MulSub) BURNISH_BRIEF(SubMul)
    BURNISH_BRIEF(Neg) BURNISH_BRIEF(Max) BURNISH_BRIEF(Min) BURNISH_BRIEF(Abs) BURNISH_BRIEF(Reciprocal)
        BURNISH_BRIEF(Sqrt) BURNISH_BRIEF(Rsqrt) BURNISH_BRIEF(Select) BURNISH_BRIEF(Square) BURNISH_BRIEF(Dot3)
#undef BURNISH_BRIEF

            template <int N>
            [[gnu::always_inline]] inline const int* operands(const Step& s, const int* more) {
  if constexpr (N <= Step::inlined) return s.at;
  else return more + s.at[0];
}
/// Operands: inputs, outputs, resource.
template <class Op>
void strip_forward(const Step& s, float* memory, float* frame, const int* more, const Environment& e) {
  constexpr int in = Op::inputs, out = Op::outputs;
  const int* const at = operands<in + out + Reads<Op>>(s, more);
  const float* x_at[in];
  int stride[in];
  float* y_at[out];
  for (int k = 0; k < in; ++k) {
    x_at[k] = (at[k] & framed ? frame : memory) + offset(at[k]);
    stride[k] = at[k] & uniform ? 0 : lanes;
  }
  for (int k = 0; k < out; ++k) y_at[k] = (at[in + k] & framed ? frame : memory) + offset(at[in + k]);
  const void* data = nullptr;
  if constexpr (Reads<Op>) data = e.resources[at[in + out]];
  const auto packet = [&](int p) __attribute__((always_inline)) {
    Lanes x[in], y[out];
    for (int k = 0; k < in; ++k) x[k] = Lanes::load(x_at[k] + p * stride[k]);
    forward<Op, Lanes>(x, y, data);
    for (int k = 0; k < out; ++k) y[k].store(y_at[k] + p * lanes);
  };
  if constexpr (brief<Op>) {
#pragma GCC unroll 16
    for (int p = 0; p < strip / lanes; ++p) packet(p);
  } else {
#pragma GCC unroll 1
    for (int p = 0; p < strip / lanes; ++p) packet(p);
  }
}
/// Operands: inputs, outputs, adjoints of the outputs, adjoints of the inputs, resource, is it fitted. M: the modes,
/// where they are few enough to be compiled one by one.
template <class Op, int... M>
void strip_backward(const Step& s, float* memory, float* frame, const int* more, const Environment& e) {
  constexpr int in = Op::inputs, out = Op::outputs;
  [[maybe_unused]] constexpr std::array<int, sizeof...(M) + 1> fixed{M...};
  const int* const at = operands<2 * in + 2 * out + 2 * Reads<Op>>(s, more);
  const float *x_at[in], *y_at[out], *d_y_at[out];
  int stride[in], mode[in];
  float* d_x_at[in];
  bool present[out];
  [[maybe_unused]] Lanes sum[in];
  for (int k = 0; k < in; ++k) {
    x_at[k] = (at[k] & framed ? frame : memory) + offset(at[k]);
    stride[k] = at[k] & uniform ? 0 : lanes;
    d_x_at[k] = memory + offset(at[in + 2 * out + k]);
    mode[k] = at[in + 2 * out + k] & 3;
  }
  for (int k = 0; k < out; ++k) {
    y_at[k] = (at[in + k] & framed ? frame : memory) + offset(at[in + k]);
    d_y_at[k] = memory + offset(at[in + out + k]);
    present[k] = out == 1 || !(at[in + out + k] & absent);
  }
  const void* data = nullptr;
  Scatter* scatter = nullptr;
  if constexpr (Reads<Op>) {
    data = e.resources[at[2 * in + 2 * out]];
    if (at[2 * in + 2 * out + 1]) scatter = e.scatters + at[2 * in + 2 * out];
  }
  const auto packet = [&](int p) __attribute__((always_inline)) {
    Lanes x[in], y[out], d_x[in], d_y[out];
    for (int k = 0; k < in; ++k) x[k] = Lanes::load(x_at[k] + p * stride[k]);
    for (int k = 0; k < out; ++k) {
      y[k] = Lanes::load(y_at[k] + p * lanes);
      d_y[k] = present[k] ? Lanes::load(d_y_at[k] + p * lanes) : Lanes(0.0f);
    }
    backward<Op, Lanes>(x, y, d_y, d_x, data, scatter);
    for (int k = 0; k < in; ++k) {
      const int m = sizeof...(M) ? fixed[std::size_t(k) % fixed.size()] : mode[k];
      float* const to = d_x_at[k] + p * lanes;
      if (m == assigned) d_x[k].store(to);
      else if (m == added) (Lanes::load(to) + d_x[k]).store(to);
      else if (m == summed) sum[k] += d_x[k];
    }
  };
  if constexpr (sizeof...(M) > 0) {
#pragma GCC unroll 16
    for (int p = 0; p < strip / lanes; ++p) packet(p);
  } else {
    for (Lanes& x : sum) x = 0.0f;
#pragma GCC unroll 1
    for (int p = 0; p < strip / lanes; ++p) packet(p);
    for (int k = 0; k < in; ++k)
      if (mode[k] == summed) (Lanes::load(d_x_at[k]) + sum[k]).store(d_x_at[k]);
  }
}
/// The player of a step back whose adjoints go where modes say.
template <class Op> Run* backward_step(const int* modes) {
  if constexpr (brief<Op> && Op::inputs == 1) {
    if (modes[0] == assigned) return strip_backward<Op, assigned>;
    if (modes[0] == added) return strip_backward<Op, added>;
  } else if constexpr (brief<Op> && Op::inputs == 2) {
    switch (modes[0] * 4 + modes[1]) {
      case 1: return strip_backward<Op, none, assigned>;
      case 2: return strip_backward<Op, none, added>;
      case 4: return strip_backward<Op, assigned, none>;
      case 5: return strip_backward<Op, assigned, assigned>;
      case 6: return strip_backward<Op, assigned, added>;
      case 8: return strip_backward<Op, added, none>;
      case 9: return strip_backward<Op, added, assigned>;
      case 10: return strip_backward<Op, added, added>;
      default: break;
    }
  }
  return strip_backward<Op>;
}

}  // namespace detail

}  // namespace burnish
