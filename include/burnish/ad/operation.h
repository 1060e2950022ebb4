// burnish/ad/operation.h -- what an operation is to the players, and apply, the door to all of them
// SPDX-License-Identifier: Apache-2.0
//
// value(a, b) gives y. back(d, y, a, b) gives d times the slope of y by each input. It is linear in d, so it serves the
// reverse sweep, the forward duals and the eager tape alike: to check one player is to check the table. Which values a
// reverse sweep must keep is not declared but found, by running back on a number that only remembers what it touched.
//
// Three forms of an operation, and apply<Op>(x...) is the door for all three:
//   arithmetic  struct Softplus : Operation<1> { static T value(T); static Back<T, 1> back(T d, T y, T x); };
//   wide        inputs, outputs;  value(const T* x, T* y);  back(const T* x, const T* y, const T* d_y, T* d_x)
//   reading     the same with `using Data = ...`, whose const reference comes first, and a Scatter* last in back, null
//               unless the data is itself a parameter (an image whose texels are fitted)
#pragma once
#include <string_view>
#include <utility>
#include <vector>
#include <burnish/ad/operations.h>

namespace burnish {

/// What the images of a recording are played with.
using Lanes = Packet<float, lanes>;

/// Where the adjoints of texels go, in the order of the pixels; added up afterwards, in the same order whatever the threads.
struct Scatter {
  struct Sixteen {
    int index[lanes];
    float value[lanes];
  };
  std::vector<Sixteen> entries;
  void add(Lanes::I index, Lanes value) {
    Sixteen& e = entries.emplace_back();
    __builtin_memcpy(e.index, &index, sizeof e.index);
    value.store(e.value);
  }
  template <Plain T> void add(int index, T value) {
    Sixteen& e = entries.emplace_back(Sixteen{});
    e.index[0] = index;
    e.value[0] = float(value);
  }
};

struct Environment;  // what a player is given beside the recording, ad/environment.h

namespace detail {

/// The arithmetic of a number type D that has D::play<Op>(array of inputs), D::less(a, b) and select(mask, a, b).
template <class D> struct Elementary {
  friend constexpr D operator+(const D& a, const D& b) { return one<op::Add>(a, b); }
  friend constexpr D operator-(const D& a, const D& b) { return one<op::Sub>(a, b); }
  friend constexpr D operator*(const D& a, const D& b) { return one<op::Mul>(a, b); }
  friend constexpr D operator/(const D& a, const D& b) { return one<op::Div>(a, b); }
  friend constexpr D operator-(const D& a) { return one<op::Neg>(a); }
  friend constexpr D& operator+=(D& a, const D& b) { return a = a + b; }
  friend constexpr D& operator-=(D& a, const D& b) { return a = a - b; }
  friend constexpr D& operator*=(D& a, const D& b) { return a = a * b; }
  friend constexpr D& operator/=(D& a, const D& b) { return a = a / b; }
  friend constexpr D sqrt(const D& a) { return one<op::Sqrt>(a); }
  friend constexpr D rsqrt(const D& a) { return one<op::Rsqrt>(a); }
  friend constexpr D exp(const D& a) { return one<op::Exp>(a); }
  friend constexpr D log(const D& a) { return one<op::Log>(a); }
  friend constexpr D exp2(const D& a) { return one<op::Exp2>(a); }
  friend constexpr D log2(const D& a) { return one<op::Log2>(a); }
  friend constexpr D pow(const D& a, const D& b) { return one<op::Pow>(a, b); }
  friend constexpr D sin(const D& a) { return one<op::Sin>(a); }
  friend constexpr D cos(const D& a) { return one<op::Cos>(a); }
  friend constexpr D tan(const D& a) { return one<op::Tan>(a); }
  friend constexpr D asin(const D& a) { return one<op::Asin>(a); }
  friend constexpr D acos(const D& a) { return one<op::Acos>(a); }
  friend constexpr D atan2(const D& y, const D& x) { return one<op::Atan2>(y, x); }
  friend constexpr D tanh(const D& a) { return one<op::Tanh>(a); }
  friend constexpr D abs(const D& a) { return one<op::Abs>(a); }
  friend constexpr D floor(const D& a) { return one<op::Floor>(a); }
  friend constexpr D max(const D& a, const D& b) { return one<op::Max>(a, b); }
  friend constexpr D min(const D& a, const D& b) { return one<op::Min>(a, b); }
  friend constexpr auto operator<(const D& a, const D& b) { return D::less(a, b); }
  friend constexpr auto operator>(const D& a, const D& b) { return D::less(b, a); }
  friend constexpr auto operator<=(const D& a, const D& b) { return !D::less(b, a); }
  friend constexpr auto operator>=(const D& a, const D& b) { return !D::less(a, b); }

private:
  template <class Op, class... A> static constexpr D one(const A&... a) {
    return D::template play<Op>(std::array<D, sizeof...(A)>{a...})[0];
  }
};

/// A number that only remembers which arguments it was made from: bit i is the i-th argument.
struct Uses : Elementary<Uses> {
  unsigned bits = 0;
  constexpr Uses() = default;
  constexpr Uses(float) {}
  static constexpr Uses of(unsigned bits) {
    Uses u;
    u.bits = bits;
    return u;
  }
  template <class Op, std::size_t N> static constexpr std::array<Uses, 1> play(const std::array<Uses, N>& x) {
    Uses u;
    for (const Uses& a : x) u.bits |= a.bits;
    return {u};
  }
  static constexpr Uses less(Uses a, Uses b) { return of(a.bits | b.bits); }
  friend constexpr Uses operator!(Uses a) { return a; }
  friend constexpr Uses operator&&(Uses a, Uses b) { return of(a.bits | b.bits); }
  friend constexpr Uses operator||(Uses a, Uses b) { return of(a.bits | b.bits); }
  friend constexpr Uses select(Uses c, Uses a, Uses b) { return of(c.bits | a.bits | b.bits); }
};

inline constexpr int max_inputs = 10, max_outputs = 14;

template <class Op> concept Reads = requires { typename Op::Data; };
template <class Op, class... A> concept ValueOf = requires(A... a) { Op::value(a...); };
template <class Op> concept Arithmetic =
    !Reads<Op> && (ValueOf<Op, float> || ValueOf<Op, float, float> || ValueOf<Op, float, float, float> ||
                   ValueOf<Op, float, float, float, float> || ValueOf<Op, float, float, float, float, float, float>);
/// False for an operation without slopes.
template <class Op> constexpr bool has_slopes() {
  if constexpr (requires { Op::active; }) return Op::active;
  else return true;
}

template <class Op, std::size_t... K, class T>
[[gnu::always_inline]] inline constexpr T value_of(std::index_sequence<K...>, const T* x) { return Op::value(x[K]...); }
template <class Op, std::size_t... K, class T>
[[gnu::always_inline]] inline constexpr auto back_of(std::index_sequence<K...>, T d, T y, const T* x) {
  return Op::back(d, y, x[K]...);
}
template <class Op, class T> [[gnu::always_inline]] inline constexpr void forward(const T* x, T* y, const void* data) {
  if constexpr (Arithmetic<Op>) y[0] = value_of<Op>(std::make_index_sequence<Op::inputs>{}, x);
  else if constexpr (Reads<Op>) Op::value(*static_cast<const typename Op::Data*>(data), x, y);
  else Op::value(x, y);
}
template <class Op, class T>
[[gnu::always_inline]] inline constexpr void backward(const T* x, const T* y, const T* d_y, T* d_x, const void* data,
                                                      Scatter* scatter) {
  if constexpr (Arithmetic<Op>) {
    const auto d = back_of<Op>(std::make_index_sequence<Op::inputs>{}, d_y[0], y[0], x);
    for (int k = 0; k < Op::inputs; ++k) d_x[k] = d[k];
  } else if constexpr (Reads<Op>) Op::back(*static_cast<const typename Op::Data*>(data), x, y, d_y, d_x, scatter);
  else Op::back(x, y, d_y, d_x);
}
/// needs[k]: the values that input k's adjoint is made from; bit i is input i, bit inputs + j is output j.
template <class Op> constexpr std::array<unsigned, max_inputs> needs() {
  static_assert(Op::inputs <= max_inputs && Op::outputs <= max_outputs,
                "burnish: an operation has at most 10 inputs and 14 outputs");
  std::array<unsigned, max_inputs> r{};
  if constexpr (Arithmetic<Op>) {
    Uses x[Op::inputs];
    for (int k = 0; k < Op::inputs; ++k) x[k] = Uses::of(1u << k);
    const auto d = back_of<Op>(std::make_index_sequence<Op::inputs>{}, Uses(), Uses::of(1u << Op::inputs), x);
    for (int k = 0; k < Op::inputs; ++k) r[k] = d[k].bits;
  } else {
    bool outputs = true;  // an operation whose back does not read y may say so
    if constexpr (requires { Op::back_reads_outputs; }) outputs = Op::back_reads_outputs;
    for (int k = 0; k < Op::inputs; ++k) r[k] = (1u << (Op::inputs + (outputs ? Op::outputs : 0))) - 1;
  }
  return r;
}
/// The same in every translation unit and in the compiler, where the address of an Info is no number.
template <class Op> constexpr unsigned name_hash() {
  unsigned h = 2166136261u;
  for (const char c : std::string_view(__PRETTY_FUNCTION__)) h = (h ^ unsigned(c)) * 16777619u;
  return h;
}

struct Step;  // an instruction of the replay, ad/replay.h
using Run = void(const Step&, float* memory, float* frame, const int* more, const Environment&);
template <class Op> void strip_forward(const Step&, float* memory, float* frame, const int* more, const Environment&);
template <class Op> Run* backward_step(const int* modes);

}  // namespace detail

/// An operation with its type taken off: what a node of a recording points to.
struct Info {
  int inputs, outputs;
  bool active, reads;
  unsigned hash;
  std::array<unsigned, detail::max_inputs> needs;
  void (*forward)(const Lanes* x, Lanes* y, const void* data);
  void (*backward)(const Lanes* x, const Lanes* y, const Lanes* d_y, Lanes* d_x, const void* data, Scatter* scatter);
  detail::Run* strip_forward;
  detail::Run* (*strip_backward)(const int* modes);
};
template <class Op> inline constexpr Info info{
    Op::inputs, Op::outputs, detail::has_slopes<Op>(), detail::Reads<Op>, detail::name_hash<Op>(), detail::needs<Op>(),
    detail::forward<Op, Lanes>, detail::backward<Op, Lanes>, detail::strip_forward<Op>, detail::backward_step<Op>};
/// By name and not by address, which is no constant to a g++ that sanitizes.
template <class Op> constexpr bool is(const Info* op) { return op->hash == detail::name_hash<Op>(); }

namespace detail {
template <class T> inline constexpr bool is_number = Plain<T> || is_packet<T> || std::is_base_of_v<Elementary<T>, T>;
}
/// Anything that arithmetic can be written with.
template <class T> concept Number = detail::is_number<std::remove_cvref_t<T>>;

/// One operation, whatever the number; y[0], y[1], ... are its outputs.
template <class Op, Number T, std::size_t N>
constexpr std::array<T, Op::outputs> apply(const std::array<T, N>& x) requires(N == Op::inputs && !detail::Reads<Op>) {
  if constexpr (requires { T::template play<Op>(x); }) return T::template play<Op>(x);
  else {
    std::array<T, Op::outputs> y{};
    detail::forward<Op, T>(x.data(), y.data(), nullptr);
    return y;
  }
}
/// The same with its inputs as arguments; an operation with one output gives it as it is.
template <class Op, Number T, class... Rest>
constexpr auto apply(const T& x, const Rest&... rest) requires(!detail::Reads<Op>) {
  const auto y = apply<Op>(std::array<T, Op::inputs>{x, T(rest)...});
  if constexpr (Op::outputs == 1) return y[0];
  else return y;
}

template <Number T> constexpr T clamp(const T& x, const same<T>& low, const same<T>& high) {
  return min(max(x, low), high);
}
/// a at t = 0, b at t = 1.
template <Number T> constexpr T mix(const T& a, const same<T>& b, const same<T>& t) { return a + (b - a) * t; }
/// 0 below low, 1 above high, 3 t^2 - 2 t^3 between.
template <Number T> constexpr T smoothstep(const same<T>& low, const same<T>& high, const T& x) {
  const T t = clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace burnish
