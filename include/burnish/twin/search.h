// burnish/twin/search.h -- which of many unit vectors point the way of another one: exact, as fast as memory is read
// SPDX-License-Identifier: Apache-2.0
//
// Vectors are rows of `columns` floats, one after the other, of unit length, so that a dot product is a cosine; any
// space will do. A row's sum is always taken in the same order, so results do not depend on the number of threads; of
// equal cosines the lower row comes first.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>
#include <burnish/ad/packet.h>
#include <burnish/ad/parallel.h>
#include <burnish/scene/error.h>

namespace burnish {

/// A row that was found.
struct Nearest {
  int row = -1;
  float cosine = -2;
};
/// A model that was found, by the best of its rows.
struct NearestModel {
  int model = -1, row = -1;
  float cosine = -2;
};

/// Every row is made one of unit length; rows of zeros stay.
inline void normalise_rows(std::span<float> rows, int columns) {
  const int n = int(rows.size() / std::size_t(columns));
  parallel_for(n, [&](int i) {
    float* const row = rows.data() + std::size_t(i) * std::size_t(columns);
    double sum = 0;
    for (int k = 0; k < columns; ++k) sum += double(row[k]) * double(row[k]);
    for (int k = 0; k < columns && sum > 0; ++k) row[k] = float(double(row[k]) / std::sqrt(sum));
  });
}

namespace detail {
/// In 64 sums side by side, added up pairwise.
inline float dot_of(const float* a, const float* b, int n) {
  using P = Packet<float, 16>;
  std::array<P, 4> sum{P(0.0f), P(0.0f), P(0.0f), P(0.0f)};
  int i = 0;
  for (; i + 64 <= n; i += 64)
    for (std::size_t k = 0; k < 4; ++k) sum[k] += P::load(a + i + 16 * int(k)) * P::load(b + i + 16 * int(k));
  alignas(64) std::array<float, 16> all;
  ((sum[0] + sum[1]) + (sum[2] + sum[3])).store(all.data());
  for (int k = 0; i + k < n; ++k) all[std::size_t(k % 16)] += a[i + k] * b[i + k];
  for (std::size_t half = 8; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) all[k] += all[k + half];
  return all[0];
}
inline void check_rows(std::span<const float> rows, int columns, std::span<const float> queries) {
  if (columns <= 0 || rows.size() % std::size_t(columns) != 0 || queries.size() % std::size_t(columns) != 0)
    throw Error("search: " + std::to_string(rows.size()) + " numbers and queries of " +
                std::to_string(queries.size()) + ", expected whole rows of " + std::to_string(columns));
}
}  // namespace detail

/// Of every row the cosine with that one of the queries (rows, too) which is nearest to it.
inline std::vector<float> cosines(std::span<const float> rows, int columns, std::span<const float> queries) {
  detail::check_rows(rows, columns, queries);
  const std::size_t step = std::size_t(columns), count = rows.size() / step, asked = queries.size() / step;
  std::vector<float> out(count, -2.0f);
  constexpr std::size_t block = 64;
  parallel_for(int((count + block - 1) / block), [&](int b) {
    for (std::size_t i = std::size_t(b) * block; i < std::min(count, std::size_t(b + 1) * block); ++i)
      for (std::size_t q = 0; q < asked; ++q)
        out[i] = std::max(out[i], detail::dot_of(rows.data() + i * step, queries.data() + q * step, columns));
  });
  return out;
}

/// The k rows nearest to a query, or to the nearest of several, best first.
inline std::vector<Nearest> nearest(std::span<const float> rows, int columns, std::span<const float> queries, int k) {
  const std::vector<float> all = cosines(rows, columns, queries);
  std::vector<Nearest> out(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) out[i] = {int(i), all[i]};
  const auto better = [](const Nearest& a, const Nearest& b) {
    return a.cosine != b.cosine ? a.cosine > b.cosine : a.row < b.row;
  };
  const std::size_t keep = std::min(out.size(), std::size_t(std::max(k, 0)));
  std::partial_sort(out.begin(), out.begin() + std::ptrdiff_t(keep), out.end(), better);
  out.resize(keep);
  return out;
}

/// The cosine of a row and a query by what is known of the query.
struct Known {
  int query = -1;
  float cosine = -2;
};
/// For each of the rows chosen its best query. known (as many as the queries have) says how far each number of a query
/// is known, 0 to 1, and weighs both the query's and the row's numbers: what is not known counts on neither side. With
/// trust > 0 what a row has there speaks against it: the norm's part that is known, to the power of trust, is a factor.
inline std::vector<Known> known_cosines(std::span<const float> rows, int columns, std::span<const int> chosen,
                                        std::span<const float> queries, std::span<const float> known,
                                        float trust = 0) {
  detail::check_rows(rows, columns, queries);
  if (known.size() != queries.size())
    throw Error("search: queries of " + std::to_string(queries.size()) + " numbers, weights of " +
                std::to_string(known.size()) + ": expected as many");
  const std::size_t step = std::size_t(columns), asked = queries.size() / step;
  std::vector<float> weighted(queries.size());
  for (std::size_t q = 0; q < asked; ++q) {
    double sum = 0;
    for (std::size_t i = q * step; i < (q + 1) * step; ++i)
      weighted[i] = queries[i] * known[i], sum += double(queries[i]) * double(weighted[i]);
    for (std::size_t i = q * step; i < (q + 1) * step && sum > 0; ++i)
      weighted[i] = float(double(weighted[i]) / std::sqrt(sum));
  }
  std::vector<Known> out(chosen.size());
  parallel_for(int(chosen.size()), [&](int i) {
    const float* const row = rows.data() + std::size_t(chosen[std::size_t(i)]) * step;
    std::vector<float> squares(row, row + step);
    for (float& v : squares) v *= v;
    for (std::size_t q = 0; q < asked; ++q) {
      const float norm = detail::dot_of(squares.data(), known.data() + q * step, columns);
      const float along = detail::dot_of(row, weighted.data() + q * step, columns);
      const float c = norm > 0 ? along / std::pow(norm, 0.5f * (1 - trust)) : -2.0f;
      if (c > out[std::size_t(i)].cosine) out[std::size_t(i)] = {int(q), c};
    }
  });
  return out;
}

/// The k models nearest to a query, or to the nearest of several, each by its best row. first[m] is model m's first
/// row, first.back() the number of all rows.
inline std::vector<NearestModel> nearest_models(std::span<const float> rows, int columns, std::span<const int> first,
                                                std::span<const float> queries, int k) {
  const std::vector<float> all = cosines(rows, columns, queries);
  std::vector<NearestModel> out;
  for (std::size_t m = 0; m + 1 < first.size(); ++m) {
    NearestModel best{int(m), -1, -2};
    for (int i = first[m]; i < first[m + 1]; ++i)
      if (all[std::size_t(i)] > best.cosine) best = {int(m), i, all[std::size_t(i)]};
    if (best.row >= 0) out.push_back(best);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const NearestModel& a, const NearestModel& b) { return a.cosine > b.cosine; });
  out.resize(std::min(out.size(), std::size_t(std::max(k, 0))));
  return out;
}

}  // namespace burnish
