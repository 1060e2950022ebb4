// burnish/ad/model.h -- a struct of numbers that lists its members once, in parameters()
// SPDX-License-Identifier: Apache-2.0
//
//   template <class T> struct Planks {
//     vec3<T> wood = {0.42f, 0.28f, 0.16f};
//     T gap = 0.006f;
//     static constexpr auto parameters() {
//       return std::tuple{Param{"wood", &Planks::wood, unit}, Param{"gap", &Planks::gap, Range{0.001f, 0.02f}}};
//     }
//   };
//
// From that list come the names, the ranges, lift<U> (the same struct in another number), for_each_parameter, the order
// of the numbers in a file and in an optimiser. A member that is left out does not compile; one that is no parameter of
// any kind (a count, a switch) is listed as Fixed{&Planks::rows}.
#pragma once
#include <string>
#include <tuple>
#include <vector>
#include <burnish/ad/operation.h>

namespace burnish {

/// Where a parameter may lie: a prior, the bounds of an optimiser and the unit of its step.
struct Range {
  float low, high;
};
inline constexpr Range unit{0, 1}, anything{-1e30f, 1e30f};

template <class S, class M> struct Param {
  const char* name;
  M S::*member;
  Range range = anything;
};
template <class S, class M> Param(const char*, M S::*) -> Param<S, M>;
template <class S, class M> Param(const char*, M S::*, Range) -> Param<S, M>;

/// A member that every copy carries along and nothing differentiates.
template <class S, class M> struct Fixed {
  M S::*member;
};
template <class S, class M> Fixed(M S::*) -> Fixed<S, M>;

template <class P> concept Model = requires { std::remove_cvref_t<P>::parameters(); };

/// P with its numbers replaced by U: Paint<float> becomes Paint<U>.
template <class P, class U> struct rebind {
  using type = P;
};
template <Number T, class U> struct rebind<T, U> {
  using type = U;
};
template <template <class> class P, Number T, class U> struct rebind<P<T>, U> {
  using type = P<U>;
};
template <class P, class U> using rebind_t = typename rebind<P, U>::type;

template <class X, std::size_t N, class U> struct rebind<std::array<X, N>, U> {
  using type = std::array<rebind_t<X, U>, N>;
};

/// An image, a table: what a look reads and no number can hold. The plain form owns the data, so that it can be a
/// parameter and a derivative; the form in any other number is a view of it.
template <class T, class D> struct Resource {
  const D* data = nullptr;
  const D& operator*() const { return *data; }
};
template <class D> struct Resource<float, D> : D {
  using D::D;
  Resource() = default;
  Resource(const D& d) : D(d) {}
  const D& operator*() const { return *this; }
};
template <class T> inline constexpr bool is_resource = false;
template <class T, class D> inline constexpr bool is_resource<Resource<T, D>> = true;
template <class T, class D, class U> struct rebind<Resource<T, D>, U> {
  using type = Resource<U, D>;
};

namespace detail {

/// Converts to anything: counts the members of an aggregate.
struct Anything {
  template <class T> operator T() const;
};
template <class P, class... A> constexpr int members() {
  if constexpr (requires { P{A{}..., Anything{}}; }) return members<P, A..., Anything>();
  else return int(sizeof...(A));
}
template <class P> constexpr int listed = int(std::tuple_size_v<decltype(P::parameters())>);
template <class P> constexpr bool complete() {
  if constexpr (std::is_aggregate_v<P>) return members<P>() == listed<P>;
  else
    return [] {
      std::size_t bytes = 0;
      std::apply([&](auto... p) { ((bytes += sizeof(std::declval<P&>().*(p.member))), ...); }, P::parameters());
      return bytes == sizeof(P);
    }();
}
template <class X> inline constexpr bool is_fixed = false;
template <class S, class M> inline constexpr bool is_fixed<Fixed<S, M>> = true;
template <class X> inline constexpr bool is_array = false;
template <class X, std::size_t N> inline constexpr bool is_array<std::array<X, N>> = true;

template <std::size_t I, class F, class A, class... B> constexpr void each_member(F& f, A& a, B&... b);
template <class F, class A, class... B, std::size_t... I>
constexpr void each_in_order(std::index_sequence<I...>, F& f, A& a, B&... b) {
  (each_member<I>(f, a, b...), ...);
}
template <class F, class A, class... B> constexpr void each_leaf(F& f, A& a, B&... b) {
  using P = std::remove_cv_t<A>;
  if constexpr (Model<P>) {
    static_assert(complete<P>(),
                  "burnish: parameters() of this struct does not list every member; add Param{\"name\", &S::member} "
                  "for a number, a vector, a node or an image, or Fixed{&S::member} for what is never fitted");
    each_in_order(std::make_index_sequence<listed<P>>{}, f, a, b...);
  } else if constexpr (is_array<P>) {
    for (std::size_t i = 0; i < a.size(); ++i) each_leaf(f, a[i], b[i]...);
  } else f(a, b...);
}
template <std::size_t I, class F, class A, class... B> constexpr void each_member(F& f, A& a, B&... b) {
  constexpr auto p = std::get<I>(std::remove_cv_t<A>::parameters());
  if constexpr (!is_fixed<std::remove_cv_t<decltype(p)>>)
    each_leaf(f, a.*p.member, b.*(std::get<I>(std::remove_cv_t<B>::parameters()).member)...);
}
template <std::size_t I, class A, class B> constexpr void copy_fixed_member(A& a, const B& b);
template <class A, class B, std::size_t... I>
constexpr void copy_fixed_in(std::index_sequence<I...>, A& a, const B& b) {
  (copy_fixed_member<I>(a, b), ...);
}
template <class A, class B> constexpr void copy_fixed(A& a, const B& b) {
  if constexpr (Model<A>) copy_fixed_in(std::make_index_sequence<listed<A>>{}, a, b);
  else if constexpr (is_array<A>)
    for (std::size_t i = 0; i < a.size(); ++i) copy_fixed(a[i], b[i]);
}
template <std::size_t I, class A, class B> constexpr void copy_fixed_member(A& a, const B& b) {
  constexpr auto p = std::get<I>(A::parameters());
  constexpr auto q = std::get<I>(B::parameters());
  if constexpr (is_fixed<std::remove_cv_t<decltype(p)>>) a.*p.member = b.*q.member;
  else copy_fixed(a.*p.member, b.*q.member);
}

template <class A> constexpr bool has_fixed_members();
template <class A, std::size_t... I> constexpr bool any_fixed(std::index_sequence<I...>) {
  return (... || [] {
    constexpr auto p = std::get<I>(A::parameters());
    if constexpr (is_fixed<std::remove_cv_t<decltype(p)>>) return true;
    else return has_fixed_members<std::remove_cvref_t<decltype(std::declval<A&>().*p.member)>>();
  }());
}
/// Does A, or a struct in it, carry what is never fitted?
template <class A> constexpr bool has_fixed_members() {
  if constexpr (Model<A>) return any_fixed<A>(std::make_index_sequence<listed<A>>{});
  else if constexpr (is_array<A>) return has_fixed_members<typename A::value_type>();
  else return false;
}

template <class F, class A> void named_leaf(F& f, A& a, const std::string& name, Range range);
template <std::size_t I, class F, class A> void named_member(F& f, A& a, const std::string& prefix, Range range) {
  constexpr auto p = std::get<I>(std::remove_cv_t<A>::parameters());
  if constexpr (!is_fixed<std::remove_cv_t<decltype(p)>>) {
    const bool own = p.range.low != anything.low || p.range.high != anything.high;
    named_leaf(f, a.*p.member, prefix.empty() ? p.name : prefix + "." + p.name, own ? p.range : range);
  }
}
template <class F, class A, std::size_t... I>
void named_in_order(std::index_sequence<I...>, F& f, A& a, const std::string& prefix, Range range) {
  (named_member<I>(f, a, prefix, range), ...);
}
template <class F, class A> void named_leaf(F& f, A& a, const std::string& name, Range range) {
  if constexpr (Model<std::remove_cv_t<A>>)
    named_in_order(std::make_index_sequence<listed<std::remove_cv_t<A>>>{}, f, a, name, range);
  else if constexpr (is_array<std::remove_cv_t<A>>)
    for (std::size_t i = 0; i < a.size(); ++i) named_leaf(f, a[i], name + "." + std::to_string(i), range);
  else f(name, a, range);
}

}  // namespace detail

/// f(x, y...) on every leaf x of a (a number or a resource), with its likes in b..., in the order of parameters().
template <class F, class A, class... B> constexpr void each(F&& f, A& a, B&... b) { detail::each_leaf(f, a, b...); }

/// f(name, leaf, range) on every leaf; names of nested structs are joined by dots: "flakes.scale", "base_color.x".
/// A range given to a struct or vector holds for those of its members that state none.
template <class F, class A> void for_each_parameter(A& a, F&& f) { detail::named_leaf(f, a, "", anything); }

/// The same struct in another number type. Numbers are converted; a resource becomes a view of the one in p.
template <class U, class P> constexpr rebind_t<P, U> lift(const P& p) {
  rebind_t<P, U> r{};
  detail::copy_fixed(r, p);
  each(
      []<class To, class From>(To& to, const From& from) {
        if constexpr (!is_resource<From>) to = To(from);
        else if constexpr (std::is_same_v<To, From>) to = from;
        else to.data = &*from;
      },
      r, p);
  return r;
}

/// How many numbers P has; a resource counts as none.
template <class P> constexpr int count() {
  int n = 0;
  P p{};
  each([&]<class X>(X&) { n += Number<X>; }, p);
  return n;
}

}  // namespace burnish
