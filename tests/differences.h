// tests/differences.h -- what holds for every differentiable function: one value in every number, and right slopes
// SPDX-License-Identifier: Apache-2.0
//
//   differences::holds("smooth_abs", [](auto x, auto width) { return smooth_abs(x, width); }, draw);
//
// At record::points() points: float, double, both packets, Var, Dual and the replayed recording give one value; the
// slopes of Var agree with Richardson differences in double (burnish/ad/check.h) to 1e-7 of themselves, those of Dual
// with them; and no value or slope is anything but a number, in float or double. The worst error of a slope is the
// figure that is recorded. At hard places, which a random point does not meet, values and slopes are numbers still,
// and the slopes those of one side.
//
// Only the numbers themselves are templates here; all else is in differences.cpp, compiled once.
#pragma once
#include <functional>
#include <random>
#include <burnish/ad/check.h>
#include <burnish/ad/dual.h>
#include <burnish/ad/recording.h>
#include <burnish/math/vec.h>
#include <burnish_test.h>
#include <record.h>

namespace differences {
using namespace burnish;
using Random = std::mt19937;

/// How near float must come, and how the differences go.
struct How {
  double rounding = 2e-5;  ///< of float against double, a part of the larger of the value and `scale`
  double scale = 1;
  double step = 1e-2;    ///< the first of the differences, relative
  double exact = 1e-12;  ///< of double against double, as rounding is of float
};
/// Places that a random point does not meet, by name. Of `points` the slopes are those to the left, to the right or
/// between; at the `stated` ones there is no slope, and f's header says what is given.
template <class Point> struct Hard {
  std::string names;
  std::vector<Point> points, stated = {};
};
/// For an f that reads data of its own (a table, an image): it cannot be recorded, float slopes are then those of Var.
template <class F> struct Unrecorded {
  F f;
  template <class... A> constexpr auto operator()(const A&... a) const { return f(a...); }
};
template <class F> Unrecorded(F) -> Unrecorded<F>;
template <class F> inline constexpr bool is_recorded = true;
template <class F> inline constexpr bool is_recorded<Unrecorded<F>> = false;

inline double between(Random& r, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(r);
}
/// Uniform over the part of the unit sphere with z >= low.
inline vec3<double> upward(Random& r, double low) {
  const double z = between(r, low, 1), phi = between(r, -3.14, 3.14), s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}
/// In the ranges that its parameters() give it, off their ends; open ranges are taken as -2 to 2.
template <class P> P inside(Random& r) {
  P p{};
  randomize(p, r);
  return p;
}
/// draw for holds: each p... anywhere inside its ranges where away(p...) holds.
template <class Away, class... P> auto within(Away away, const P&... p) {
  return [=](Random& r) {
    std::tuple<P...> t{p...};
    do std::apply([&](auto&... a) { (randomize(a, r), ...); }, t);
    while (!std::apply(away, t));
    return t;
  };
}
inline constexpr auto anywhere = [](const auto&...) { return true; };

/// A point inside the ranges of p..., rounded to float, so that every number type stands on the same one.
void round_to_float(double& x);
template <class R, class... P> void move(R& random, P&... p) {
  (randomize(p, random), ...);
  (each(
       [](auto& x) {
         if constexpr (std::is_same_v<std::remove_reference_t<decltype(x)>, double>) round_to_float(x);
       },
       p),
   ...);
}

namespace parts {
template <class Y> struct leaf { using type = Y; };
template <template <class...> class P, class T, class... R>
requires(!Number<P<T, R...>>) struct leaf<P<T, R...>> : leaf<T> {
};
template <class T, std::size_t N> struct leaf<std::array<T, N>> : leaf<T> {};
template <class M, class Y> constexpr void mix_in(M& m, const Y& y) {
  if constexpr (Number<Y>) m(y);
  else if constexpr (Model<Y> || burnish::detail::is_array<Y>) each([&](const auto& x) { m(x); }, y);
  else if constexpr (requires { y.slope; }) mix_in(m, y.value), mix_in(m, y.slope);
  else mix_in(m, y.t), mix_in(m, y.b), mix_in(m, y.n);
}
}  // namespace parts
/// One number out of a result (a number, vector, height, frame, struct or array): a fixed mixture of its components.
template <class Y> constexpr auto mixture(const Y& y) {
  if constexpr (Number<Y>) return y;
  else {
    using T = typename parts::leaf<Y>::type;
    T sum = 0.0f;
    int k = 0;
    const auto add = [&](const T& x) {
      constexpr float first[] = {0.75f, -1.25f, 0.875f};
      sum = sum + x * (k < 3 ? first[k] : 0.125f + 0.25f * float(k * 7 % 11 - 5));
      ++k;
    };
    parts::mix_in(add, y);
    return sum;
  }
}

/// A function of numbers with its types taken off. x: the numbers of all arguments, in order.
class Function {
public:
  using Numbers = std::vector<double>;
  virtual ~Function() = default;
  virtual std::vector<std::string> names() = 0;
  virtual Numbers draw(Random&) = 0;
  virtual Numbers hard(std::size_t i, bool one_sided) = 0;  ///< the i-th of the hard places; empty past the last
  virtual double in_double(const Numbers& x) = 0;
  virtual double in_float(const Numbers& x) = 0;
  virtual double in_packet(const Numbers& x, int lane) = 0;  ///< of floats
  virtual double in_double_packet(const Numbers& x, int lane) = 0;
  virtual double taped(const Numbers& x, Numbers& d) = 0;
  virtual double dual(const Numbers& x, const Numbers& direction, double& slope) = 0;
  virtual bool record(Recording& r) = 0;                            ///< false: it cannot be
  virtual double taped_in_float(const Numbers& x, Numbers& d) = 0;  ///< where it cannot be recorded
};
/// hard: their names, empty for none.
void check(const std::string& names, Function& f, const How& how, const std::string& hard);

template <class F, class Point> class Typed final : public Function {
public:
  using Draw = std::function<Point(Random&)>;
  Typed(F& f_, const Draw& draw_, const Hard<Point>& hard_) : f(f_), draw_point(draw_), places(hard_) {}

  std::vector<std::string> names() override {
    std::vector<std::string> list;
    int k = 0;
    const auto add = [&](auto& a) {
      const std::string number = std::to_string(k++);
      for_each_parameter(a, [&]<class X>(const std::string& n, X&, Range) {
        if constexpr (Plain<X>) list.push_back(number + (n.empty() ? "" : "." + n));
      });
    };
    std::apply([&](auto&... a) { (add(a), ...); }, point);
    return list;
  }
  Numbers draw(Random& random) override { return taken(draw_point(random)); }
  Numbers hard(std::size_t i, bool one_sided) override {
    const std::vector<Point>& list = one_sided ? places.points : places.stated;
    return i < list.size() ? taken(list[i]) : Numbers();
  }
  double in_double(const Numbers& x) override {
    put(x);
    return std::apply([&](const auto&... a) { return mixture(f(a...)); }, point);
  }
  double in_float(const Numbers& x) override { return double(of<float>(x)); }
  double in_packet(const Numbers& x, int lane) override { return double(of<Packet<float, 16>>(x)[lane]); }
  double in_double_packet(const Numbers& x, int lane) override { return of<Packet<double, 8>>(x)[lane]; }
  double taped(const Numbers& x, Numbers& d) override {
    put(x);
    return by_tape(point, d);
  }
  double taped_in_float(const Numbers& x, Numbers& d) override {
    if constexpr (is_recorded<F>) return 0;
    else {
      put(x);
      return by_tape(std::apply([](const auto&... a) { return std::tuple{lift<float>(a)...}; }, point), d);
    }
  }
  double dual(const Numbers& x, const Numbers& direction, double& slope) override {
    put(x);
    auto p = lifted<Dual<double, 1>>();
    std::size_t i = 0;
    each_number<Dual<double, 1>>(p, [&](Dual<double, 1>& to) { to.slope[0] = direction[i++]; });
    const auto y = std::apply([&](const auto&... a) { return mixture(f(a...)); }, p);
    slope = y.slope[0];
    return y.value;
  }
  bool record(Recording& r) override {
    if constexpr (is_recorded<F>) {
      auto p = lifted<Recorded>();
      each_number<Recorded>(p, [&](Recorded& to) { to = Recorded(&r, r.input(Kind::pixel, r.pixels++, true)); });
      r.outputs.push_back(Recorded(std::apply([&](const auto&... a) { return mixture(f(a...)); }, p)).node(&r));
      return true;
    } else return false;
  }

private:
  F& f;
  const Draw& draw_point;
  const Hard<Point>& places;
  Point point{};

  template <class X, class P, class Visit> static void each_number(P& p, Visit visit) {
    const auto leaf = [&]<class Y>(Y& y) {
      if constexpr (std::is_same_v<Y, X>) visit(y);
    };
    std::apply([&](auto&... a) { (each(leaf, a), ...); }, p);
  }
  Numbers taken(const Point& p) {
    point = p;
    Numbers x;
    each_number<double>(point, [&](double& from) { x.push_back(from); });
    return x;
  }
  void put(const Numbers& x) {
    std::size_t i = 0;
    each_number<double>(point, [&](double& to) { to = x[i++]; });
  }
  template <class T> auto lifted() const {
    return std::apply(
        [](const auto&... a) { return std::tuple<rebind_t<std::remove_cvref_t<decltype(a)>, T>...>{lift<T>(a)...}; },
        point);
  }
  template <class T> T of(const Numbers& x) {
    put(x);
    return std::apply([&](const auto&... a) { return T(mixture(f(a...))); }, lifted<T>());
  }
  template <class P> double by_tape(const P& p, Numbers& d) {
    const auto all = std::apply(
        [&](const auto&... a) { return differentiate([&](const auto&... b) { return mixture(f(b...)); }, a...); }, p);
    d.clear();
    std::apply(
        [&](const auto&, const auto&... a) {
          (each(
               [&]<class X>(const X& x) {
                 if constexpr (Plain<X>) d.push_back(double(x));
               },
               a),
           ...);
        },
        all);
    return double(std::get<0>(all));
  }
};

/// names: f's public name, or several joined by ", ". draw(random) gives a tuple of f's arguments, numbers or structs
/// of double, off the edges of f.
template <class F, class Draw, class Point = decltype(std::declval<Draw&>()(std::declval<Random&>()))>
void holds(const std::string& names, F f, Draw draw, const How& how = {},
           const std::type_identity_t<Hard<Point>>& hard = {}) {
  const typename Typed<F, Point>::Draw drawn = draw;
  Typed<F, Point> typed(f, drawn, hard);
  check(names, typed, how, hard.names);
}

}  // namespace differences
