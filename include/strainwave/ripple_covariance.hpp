// SPDX-License-Identifier: Apache-2.0
/// @file ripple_covariance.hpp
/// The ripple filter's covariance P, described so that float is enough.
///
/// Two pairs that cannot be told apart for a minute (load and constant at a constant load) have
/// large variances whose difference is small; in float P would lose that difference, and its sign
/// with it.  The covariance is therefore not that of the coefficients, but of each order's ripple
/// at a load, speed and direction near the present ones (the frame), and of the further pairs.
/// What is measured well and what is hardly seen are then different variables.  When load or speed
/// have gone too far, the frame moves after them.
///
/// T's row is kept beside the coefficients', because a jump of torque touches it alone.
#pragma once

#include <cstddef>
#include <type_traits>

#include "strainwave/arithmetic.hpp"
#include "strainwave/number_row.hpp"
#include "strainwave/ripple_config.hpp"

namespace strainwave {

namespace detail {

#if defined(STRAINWAVE_NUMBER_ROWS)
/// Whole rows of P, in vectors: twice the memory, and far fewer instructions where there are any.
inline constexpr bool whole_rows = true;
#else
inline constexpr bool whole_rows = false;
#endif

/// Elements from row to row: where whole rows are kept, a number that registers can be filled with.
[[nodiscard]] constexpr std::size_t row_length_of(std::size_t coefficients) {
  if (!whole_rows || coefficients <= 2) {
    return coefficients;
  }
  return coefficients <= 4 ? 4 : (coefficients + 7) / 8 * 8;
}

}  // namespace detail

/// What an order's further pairs are multiplied by, in their order; the first pair's factor is 1.
template <class Real>
struct OrderTerms {
  Real factors[3] = {};
};

namespace detail {

/// How far factors may be from the frame's before it moves: near enough for float, and far enough
/// that a sample on which it moves is rare.
inline constexpr float widest_frame_offset = 1.0F / 16.0F;

}  // namespace detail

template <class Real, std::size_t MaxPairs>
struct RippleCovariance {
  static constexpr std::size_t max_coefficients = 2 * MaxPairs;
  static constexpr std::size_t row_length = detail::row_length_of(max_coefficients);
  static constexpr std::size_t element_count = detail::whole_rows
                                                   ? max_coefficients * row_length
                                                   : max_coefficients * (max_coefficients + 1) / 2;

  /// Of the coefficients in the frame, without T.  Whole rows, or the lower triangle by rows.
  Real elements_Nm2[element_count] = {};
  Real torque_row_Nm2[row_length] = {};  ///< of T with the coefficients in the frame
  Real torque_variance_Nm2 = Real(0);
  Real frames[MaxPairs][3] = {};  ///< factors of each order's further pairs
};

namespace detail {

/// Calls with the number of coefficients: as a constant where all of the capacity is in use, so
/// that the compiler can write out the loops.
template <std::size_t Capacity, class Call>
constexpr auto with_count(std::size_t count, const Call& call) {
  return count == Capacity ? call(std::integral_constant<std::size_t, Capacity>{}) : call(count);
}

// Count: std::size_t, or a std::integral_constant of it.

template <std::size_t From, std::size_t To, class Call>
constexpr void call_each(const Call& call) {
  if constexpr (From < To) {
    call(std::integral_constant<std::size_t, From>{});
    call_each<From + 1, To>(call);
  }
}

/// Keeps the compiler from loading ahead what it then has no registers for: what is written out
/// here reads an element of P twice, and to keep it meanwhile costs a store more than to read it.
constexpr void begin_anew() {
#if defined(__GNUC__)
  if (!whole_rows && !std::is_constant_evaluated()) {
    asm volatile("" : : : "memory");  // NOLINT(*-no-assembler)
  }
#endif
}

/// Calls with 0 to count - 1; written out for a constant count, where that saves a microcontroller
/// the counting, and keeps what a loop would put into memory in registers.
template <class Count, class Call>
constexpr void repeat(Count count, const Call& call) {
  if constexpr (!whole_rows && !std::is_same_v<Count, std::size_t>) {
    call_each<0, Count::value>(call);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      call(i);
    }
  }
}

template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr std::size_t element_index(const RippleCovariance<Real, MaxPairs>& /*p*/,
                                                  std::size_t row, std::size_t column) {
  if constexpr (whole_rows) {
    return row * RippleCovariance<Real, MaxPairs>::row_length + column;
  } else {
    return row >= column ? row * (row + 1) / 2 + column : column * (column + 1) / 2 + row;
  }
}

/// Element of the coefficients' block in the frame.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real element_of(const RippleCovariance<Real, MaxPairs>& p, std::size_t row,
                                        std::size_t column) {
  return p.elements_Nm2[element_index(p, row, column)];
}

template <class Real, std::size_t MaxPairs>
constexpr void set_element(RippleCovariance<Real, MaxPairs>& p, std::size_t row, std::size_t column,
                           Real value_Nm2) {
  p.elements_Nm2[element_index(p, row, column)] = value_Nm2;
  if constexpr (whole_rows) {
    // NOLINTNEXTLINE(readability-suspicious-call-argument): the other half
    p.elements_Nm2[element_index(p, column, row)] = value_Nm2;
  }
}

template <class Real, std::size_t MaxPairs>
constexpr void add_to_element(RippleCovariance<Real, MaxPairs>& p, std::size_t row,
                              std::size_t column, Real value_Nm2) {
  set_element(p, row, column, element_of(p, row, column) + value_Nm2);
}

template <class Real, std::size_t MaxPairs>
using RowOf = WideRow<Real, RippleCovariance<Real, MaxPairs>::row_length>;

/// Uncorrelated coefficients of one variance.
template <class Real, std::size_t MaxPairs>
constexpr void set_uncorrelated(RippleCovariance<Real, MaxPairs>& p, Real variance_Nm2) {
  p = RippleCovariance<Real, MaxPairs>{};
  for (std::size_t i = 0; i < 2 * MaxPairs; ++i) {
    set_element(p, i, i, variance_Nm2);
  }
}

/// sum += factor x row.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void add_row(const RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t row,
                       Real factor, Real* sum) {
  for (std::size_t j = 0; j < count; ++j) {
    sum[j] += factor * element_of(p, row, j);
  }
}

/// A row put in place of another one, and of its column.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void replace_row(RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t row,
                           const Real* elements) {
  for (std::size_t j = 0; j < count; ++j) {
    set_element(p, row, j, elements[j]);
  }
}

/// Calls with each order and the first of its coefficients, and with none that the capacity does
/// not hold (check() refuses such a configuration).  Written out where no whole rows are kept:
/// there the configuration is a constant, and places in P then are constants, too.
template <class Real, std::size_t MaxPairs, class Call>
constexpr void each_order(const RippleFilterConfig<Real, MaxPairs>& config, const Call& call) {
  if constexpr (whole_rows) {
    std::size_t b = 0;
    for (std::size_t a = 0; a < config.order_count && a < MaxPairs; ++a) {
      const std::size_t end = b + 2 * pairs_of(config.orders[a]);
      if (end > 2 * MaxPairs) {
        return;
      }
      call(a, b);
      b = end;
    }
  } else {
    std::size_t b = 0;
    call_each<0, MaxPairs>([&](std::size_t a) {
      if (a < config.order_count && b + 2 * pairs_of(config.orders[a]) <= 2 * MaxPairs) {
        call(a, b);
        b += 2 * pairs_of(config.orders[a]);
      }
    });
  }
}

/// The ripple of an order, coefficient b of its first pair, moves by steps x further pairs.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void move_row(RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t b,
                        std::size_t terms, const OrderTerms<Real>& steps) {
  Real row[RippleCovariance<Real, MaxPairs>::row_length];  // NOLINT(*-member-init)
  for (std::size_t j = 0; j < count; ++j) {
    row[j] = element_of(p, b, j);
  }
  for (std::size_t t = 0; t < terms; ++t) {
    add_row(p, count, b + 2 * (t + 1), steps.factors[t], row);
    p.torque_row_Nm2[b] += steps.factors[t] * p.torque_row_Nm2[b + 2 * (t + 1)];
  }
  for (std::size_t t = 0; t < terms; ++t) {
    row[b] += steps.factors[t] * row[b + 2 * (t + 1)];
  }
  replace_row(p, count, b, row);
}

/// Moves an order's frame by steps, b the order's first coefficient.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void move_frame(RippleCovariance<Real, MaxPairs>& p, Count count, std::size_t a,
                          std::size_t b, std::size_t terms, const OrderTerms<Real>& steps) {
  for (std::size_t t = 0; t < terms; ++t) {
    p.frames[a][t] += steps.factors[t];
  }
  move_row(p, count, b, terms, steps);
  move_row(p, count, b + 1, terms, steps);
}

/// Share of its process noise that a pair is given, i its first coefficient: all while it is well
/// known, nothing where it is as little known as before anything was learned, as a load pair at
/// constant load becomes.  That is how the variance of a coefficient grows that wanders about 0 and
/// not without end.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real share_of_noise(const RippleCovariance<Real, MaxPairs>& p,
                                            std::size_t i, Real limit_Nm2) {
  const Real share =
      Real(1) - (element_of(p, i, i) + element_of(p, i + 1, i + 1)) * (Real(0.5) / limit_Nm2);
  return share > Real(0) ? share : Real(0);
}

/// Adds process noise of one variance to an order's coefficients, b the first of them.  Returns
/// whether a pair was given nothing.
template <class Real, std::size_t MaxPairs>
constexpr bool add_noise(RippleCovariance<Real, MaxPairs>& p, std::size_t a, std::size_t b,
                         std::size_t terms, Real variance_Nm2, Real limit_Nm2) {
  Real weight = Real(1);
  Real sum_Nm2 = Real(0);
  Real smallest_share = Real(1);
  for (std::size_t t = 0; t < terms; ++t) {
    const std::size_t i = b + 2 * (t + 1);
    const Real factor = p.frames[a][t];
    const Real share = share_of_noise(p, i, limit_Nm2);
    const Real its_Nm2 = variance_Nm2 * share;
    smallest_share = share < smallest_share ? share : smallest_share;
    for (std::size_t side = 0; side < 2; ++side) {
      add_to_element(p, i + side, b + side, factor * its_Nm2);
      add_to_element(p, i + side, i + side, its_Nm2);
    }
    sum_Nm2 += factor * factor * its_Nm2;
    weight += factor * factor;
  }
  const Real share = share_of_noise(p, b, weight * limit_Nm2);
  sum_Nm2 += variance_Nm2 * share;
  add_to_element(p, b, b, sum_Nm2);
  add_to_element(p, b + 1, b + 1, sum_Nm2);
  return !(share > Real(0) && smallest_share > Real(0));
}

/// What a measurement T + h'c sees of P, in the frame.
template <class Real, std::size_t MaxPairs>
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
struct SeenCovariance {
  static constexpr std::size_t row_length = RippleCovariance<Real, MaxPairs>::row_length;

  Real h[row_length];
  Real ripple_row_Nm2[row_length];  ///< P h of the coefficients alone
  Real ripple_variance_Nm2;         ///< h'P h of the coefficients alone
  Real shared_Nm2;                  ///< T with the ripple
};

/// Where whole rows are read, what the filter does not have of them is no garbage.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void clear_rest(SeenCovariance<Real, MaxPairs>& seen, Count count) {
  for (std::size_t i = count; whole_rows && i < seen.row_length; ++i) {
    seen.h[i] = Real(0);
  }
}

/// Moves the frame after factors that have gone too far from it: of one order a sample, so that no
/// sample costs much more than another.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void follow(const RippleFilterConfig<Real, MaxPairs>& config,
                      RippleCovariance<Real, MaxPairs>& p, Count count,
                      const OrderTerms<Real>* terms) {
  bool moved = false;
  each_order(config, [&](std::size_t a, std::size_t b) {
    const std::size_t its_terms = further_pairs_of(config.orders[a]);
    OrderTerms<Real> offsets;
    bool too_far = false;
    for (std::size_t t = 0; t < its_terms; ++t) {
      offsets.factors[t] = terms[a].factors[t] - p.frames[a][t];
      too_far = too_far || absolute(offsets.factors[t]) > static_cast<Real>(widest_frame_offset);
    }
    if (too_far && !moved) {
      moved = true;
      move_frame(p, count, a, b, its_terms, offsets);
    }
  });
}

// NOLINTBEGIN(clang-analyzer-security.ArrayBound,clang-analyzer-core.CallAndMessage)
// Counts are those of the configuration, and each_order() keeps to the capacity.

/// Regressors in the frame: an order's ripple is seen as it is, a further pair as far as its factor
/// is from the frame's.
template <class Real, std::size_t MaxPairs>
constexpr void enter_frame(const RippleFilterConfig<Real, MaxPairs>& config,
                           const RippleCovariance<Real, MaxPairs>& p, const OrderTerms<Real>* terms,
                           const CosSin<Real>* waves, Real* h) {
  each_order(config, [&](std::size_t a, std::size_t b) {
    h[b] = waves[a].cosine;
    h[b + 1] = waves[a].sine;
    for (std::size_t t = 0; t < further_pairs_of(config.orders[a]); ++t) {
      const Real offset = terms[a].factors[t] - p.frames[a][t];
      h[b + 2 * t + 2] = offset * waves[a].cosine;
      h[b + 2 * t + 3] = offset * waves[a].sine;
    }
  });
}

/// P h of the coefficients, in two sums side by side: a chain of as many additions would be waited
/// for.  The same sums in the same order in both ways of keeping P.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void project(const RippleCovariance<Real, MaxPairs>& p, Count count, const Real* h,
                       Real* projected) {
  if constexpr (whole_rows) {
    using Row = RowOf<Real, MaxPairs>;
    const auto product = [&](std::size_t i) {
      return Row::all(h[i]) * Row::load(p.elements_Nm2 + element_index(p, i, 0));
    };
    Row cosines = product(0);
    Row sines = product(1);
    for (std::size_t i = 2; i + 1 < count; i += 2) {
      cosines = cosines + product(i);
      sines = sines + product(i + 1);
    }
    (cosines + sines).store(projected);
  } else {
    repeat(count, [&](auto j) {
      Real sums[2] = {};
      repeat(count, [&](auto i) { sums[i % 2] += h[i] * element_of(p, i, j); });
      projected[j] = sums[0] + sums[1];
      begin_anew();
    });
  }
}

/// Sum of products, in four sums side by side: a chain of as many additions would be waited for.
template <class Real, class Count>
[[nodiscard]] constexpr Real product_sum(Count count, const Real* a, const Real* b) {
  Real sums[4] = {};
  repeat(count, [&](auto i) { sums[i % 4] += a[i] * b[i]; });
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Sees P with the regressors seen.h.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void see(const RippleCovariance<Real, MaxPairs>& p, Count count,
                   SeenCovariance<Real, MaxPairs>& seen) {
  clear_rest(seen, count);
  project(p, count, seen.h, seen.ripple_row_Nm2);
  if constexpr (whole_rows && SeenCovariance<Real, MaxPairs>::row_length >= 4) {
    using Row = RowOf<Real, MaxPairs>;
    seen.ripple_variance_Nm2 = product_sum_by_fours<Row>(seen.h, seen.ripple_row_Nm2);
    seen.shared_Nm2 = product_sum_by_fours<Row>(seen.h, p.torque_row_Nm2);
  } else {
    seen.ripple_variance_Nm2 = product_sum(count, seen.h, seen.ripple_row_Nm2);
    seen.shared_Nm2 = product_sum(count, seen.h, p.torque_row_Nm2);
  }
}

/// T's row after a measurement of noise R and variance s; puts P h with T into `row`.  With r = s
/// less the covariance of T and the measurement,
///     P_TT = R + h'P_c h - r^2 / s,  P_Tc = r / s P h - P_c h,
/// in which P_TT before the measurement does not stand: a jump of torque may be as large as it
/// likes.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void measure_torque(RippleCovariance<Real, MaxPairs>& p, Count count,
                              const SeenCovariance<Real, MaxPairs>& seen, Real noise_Nm2,
                              Real per_variance, Real* row_Nm2) {
  const Real rest_Nm2 = noise_Nm2 + seen.ripple_variance_Nm2 + seen.shared_Nm2;
  const Real left = rest_Nm2 * per_variance;
  p.torque_variance_Nm2 = noise_Nm2 + seen.ripple_variance_Nm2 - left * rest_Nm2;
  if constexpr (whole_rows) {
    using Row = RowOf<Real, MaxPairs>;
    const Row ripple = Row::load(seen.ripple_row_Nm2);
    const Row row = ripple + Row::load(p.torque_row_Nm2);
    row.store(row_Nm2);
    (Row::all(left) * row - ripple).store(p.torque_row_Nm2);
  } else {
    repeat(count, [&](auto j) {
      row_Nm2[j] = seen.ripple_row_Nm2[j] + p.torque_row_Nm2[j];
      p.torque_row_Nm2[j] = left * row_Nm2[j] - seen.ripple_row_Nm2[j];
    });
  }
}

/// The coefficients' block after a measurement: P - P h h'P / s, from P h and 1 / sqrt(s).
/// Products of one vector with itself, so that both halves of P get the same numbers.
template <class Real, std::size_t MaxPairs, class Count>
constexpr void measure_coefficients(RippleCovariance<Real, MaxPairs>& p, Count count,
                                    const Real* row_Nm2, Real per_deviation) {
  Real scaled[RippleCovariance<Real, MaxPairs>::row_length];  // NOLINT(*-member-init)
  if constexpr (whole_rows) {
    using Row = RowOf<Real, MaxPairs>;
    const Row all = Row::load(row_Nm2) * Row::all(per_deviation);
    all.store(scaled);
    for (std::size_t i = 0; i < count; ++i) {
      Real* const elements = p.elements_Nm2 + element_index(p, i, 0);
      (Row::load(elements) - Row::all(scaled[i]) * all).store(elements);
    }
  } else {
    repeat(count, [&](auto j) { scaled[j] = row_Nm2[j] * per_deviation; });
    repeat(count, [&](auto i) {
      Real* const elements = p.elements_Nm2 + element_index(p, i, 0);
      repeat(i, [&](auto j) { elements[j] -= scaled[i] * scaled[j]; });
      elements[i] -= scaled[i] * scaled[i];
    });
  }
}

/// From the frame to the coefficients themselves: an order's first pair is its ripple less what the
/// further pairs make of it.
template <class Real, std::size_t MaxPairs>
constexpr void leave_frame(const RippleFilterConfig<Real, MaxPairs>& config,
                           const RippleCovariance<Real, MaxPairs>& p, Real* vector) {
  each_order(config, [&](std::size_t a, std::size_t b) {
    for (std::size_t t = 0; t < further_pairs_of(config.orders[a]); ++t) {
      vector[b] -= p.frames[a][t] * vector[b + 2 * t + 2];
      vector[b + 1] -= p.frames[a][t] * vector[b + 2 * t + 3];
    }
  });
}

/// Row of P of the coefficients themselves, T first; row 0 is T's.
template <class Real, std::size_t MaxPairs>
constexpr void covariance_row(const RippleFilterConfig<Real, MaxPairs>& config,
                              const RippleCovariance<Real, MaxPairs>& p, std::size_t count,
                              std::size_t row, Real* result) {
  // Row i of S P S' is S P (row i of S)'.
  Real weights[2 * MaxPairs] = {};
  each_order(config, [&](std::size_t a, std::size_t b) {
    for (std::size_t t = 0; t < further_pairs_of(config.orders[a]); ++t) {
      for (std::size_t side = 0; side < 2; ++side) {
        weights[b + 2 * t + 2 + side] = row == b + side + 1 ? -p.frames[a][t] : Real(0);
      }
    }
  });
  result[0] = row == 0 ? p.torque_variance_Nm2 : Real(0);
  if (row > 0) {
    weights[row - 1] = Real(1);
  }
  for (std::size_t j = 0; j < count; ++j) {
    result[0] += weights[j] * p.torque_row_Nm2[j];
    result[j + 1] = row == 0 ? p.torque_row_Nm2[j] : Real(0);
    for (std::size_t i = 0; i < count && row > 0; ++i) {
      result[j + 1] += weights[i] * element_of(p, i, j);
    }
  }
  leave_frame(config, p, result + 1);
}

/// Element of P of the coefficients themselves; indices as in the filter's states, 0 is T.
template <class Real, std::size_t MaxPairs>
[[nodiscard]] constexpr Real covariance_of(const RippleFilterConfig<Real, MaxPairs>& config,
                                           const RippleCovariance<Real, MaxPairs>& p,
                                           std::size_t count, std::size_t a, std::size_t b) {
  Real row[1 + 2 * MaxPairs] = {};
  covariance_row(config, p, count, a, row);
  return row[b];
}

// NOLINTEND(clang-analyzer-security.ArrayBound,clang-analyzer-core.CallAndMessage)

}  // namespace detail

}  // namespace strainwave
