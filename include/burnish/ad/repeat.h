// burnish/ad/repeat.h -- a sum over a list of run-time length: the only loop over numbers a recording knows
// SPDX-License-Identifier: Apache-2.0
//
// A list of fixed length (std::array) in an ordinary `for` is unrolled into the recording; that is fastest up to a few
// hundred operations. A list of any length goes through repeat, whose body is recorded once.
#pragma once
#include <span>
#include <burnish/ad/recording.h>

namespace burnish {

/// A list of items that is the same for all pixels (lights, samples), seen as items of T. Item has parameters().
template <template <class> class Item, class T> struct List {
  std::span<const Item<float>> items;
};
template <template <class> class Item> struct List<Item, Recorded> {
  Recording* recording = nullptr;
  int index = 0;
};

/// A vector of items handed to a look is seen as a List.
template <template <class> class Item, class A, class U> struct rebind<std::vector<Item<float>, A>, U> {
  using type = List<Item, U>;
};

/// The sum of f(item) over the list; f gives a number, a vector or any struct with parameters().
template <template <class> class Item, class T, class F> constexpr auto repeat(const List<Item, T>& list, F&& f) {
  static_assert(!detail::has_fixed_members<Item<T>>(),
                "burnish: the items of a list hold numbers only; what is Fixed in them no recording can know");
  if constexpr (std::is_same_v<T, Recorded>) {
    Recording& r = *list.recording;
    if (r.open >= 0)
      throw std::logic_error("burnish: repeat inside repeat is not recorded; flatten the two lists into one");
    Loop loop;
    loop.list = list.index;
    loop.begin = int(r.nodes.size());
    r.open = int(r.loops.size());
    r.loops.push_back(loop);
    Item<T> item{};
    int field = 0;
    each([&](T& x) { x = T(&r, r.input(Kind::item, field++, false)); }, item);
    auto sum = f(static_cast<const Item<T>&>(item));
    int n = 0;
    each([&](T& x) {
      x = T(&r, x.node(&r));
      ++n;
    }, sum);
    loop.end = loop.first_sum = int(r.nodes.size());
    loop.sums = n;
    each([&](T& x) {
      Node s;
      s.kind = Kind::sum;
      s.loop = r.open;
      s.in[0] = x.id;
      s.active = r.nodes[std::size_t(x.id)].active;
      s.varying = true;
      x = T(&r, r.add(s));
    }, sum);
    r.loops[std::size_t(r.open)] = loop;
    r.open = -1;
    return sum;
  } else {
    auto sum = decltype(f(Item<T>{})){};
    each([](T& x) { x = T(0.0f); }, sum);
    for (const Item<float>& item : list.items) {
      const auto term = f(lift<T>(item));
      each([](T& s, const T& t) { s = s + t; }, sum, term);
    }
    return sum;
  }
}

}  // namespace burnish
