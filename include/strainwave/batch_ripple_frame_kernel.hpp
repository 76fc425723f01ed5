// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_frame_kernel.hpp
/// Lanes move an order's frame after load and speed: rare, and kept out of the way of what is not.
///
/// Included by batch_ripple.hpp within the namespace of each vector level.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers, as the published filter's kernel.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline
#define STRAINWAVE_KERNEL \
  [[gnu::noinline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

/// The frames of one group of lanes.
template <class Real, std::size_t Pairs>
struct RippleFrames {
  using L = Lanes<Real>;
  using Mask = LaneMask<Real>;
  static constexpr std::size_t coefficients = 2 * Pairs;

  static constexpr detail::LanePlaces<coefficients> places = {};

  // NOLINTNEXTLINE(cppcoreguidelines-avoid-const-or-ref-data-members): lives for one sample.
  RippleLanes<Real, Pairs>& memory;
  std::size_t lane;
  const L* factors;  ///< by RippleFactor

  STRAINWAVE_INLINE L load(const Real* of_row) const { return L::load(of_row + lane); }
  STRAINWAVE_INLINE void store(L value, Real* of_row) const { value.store(of_row + lane); }
  STRAINWAVE_INLINE void add_to(Real* of_row, L value) const {
    store(load(of_row) + value, of_row);
  }
  [[nodiscard]] STRAINWAVE_INLINE Real* element(std::size_t i, std::size_t j) const {
    return memory.covariance_Nm2[places.of[i][j]];
  }

  /// Moves an order of those lanes of the given ones whose factors are beyond a share of the widest
  /// offset; returns which have moved.
  // NOLINTNEXTLINE(modernize-use-nodiscard): for who wants to know
  STRAINWAVE_INLINE Mask follow(std::size_t a, Real share, Mask lanes) const {
    const RippleOrderLayout& order = memory.orders[a];
    L steps[3];
    Mask too_far = L(Real(1)) <= L(Real(0));
    for (std::size_t t = 0; t < order.terms; ++t) {
      const std::size_t pair = order.first_pair + 1 + t;
      steps[t] = factors[memory.factor_of[pair]] - load(memory.frames[pair]);
      too_far = too_far | (absolute(steps[t]) > L(share * memory.widest_offset[pair]));
    }
    too_far = too_far & lanes;
    if (too_far.any()) {
      move(order, too_far, steps);
    }
    return too_far;
  }

  /// move_frame() of ripple_covariance.hpp.
  STRAINWAVE_INLINE void move(const RippleOrderLayout& order, Mask lanes, L* steps) const {
    L weight = Real(1);
    for (std::size_t t = 0; t < order.terms; ++t) {
      Real* const frame = memory.frames[order.first_pair + 1 + t];
      steps[t] = select(lanes, steps[t], L(Real(0)));
      add_to(frame, steps[t]);
      weight = fused(load(frame), load(frame), weight);
    }
    store(load(memory.half_per_limit) / weight, memory.half_per_limits[order.first_pair]);
    move_row(2 * order.first_pair, order.terms, steps);
    move_row(2 * order.first_pair + 1, order.terms, steps);
  }

  /// move_row() of ripple_covariance.hpp, and the ripple of the order itself.
  STRAINWAVE_INLINE void move_row(std::size_t b, std::size_t terms, const L* steps) const {
    L diagonal = load(element(b, b));
    for (std::size_t t = 0; t < terms; ++t) {
      const std::size_t i = b + 2 * (t + 1);
      diagonal = fused(steps[t], load(element(i, b)), diagonal);
      add_to(memory.torque_row_Nm2[b], steps[t] * load(memory.torque_row_Nm2[i]));
      add_to(memory.coefficients_Nm[b], steps[t] * load(memory.coefficients_Nm[i]));
    }
    for (std::size_t j = 0; j < coefficients; ++j) {
      if (j != b) {
        L moved = load(element(b, j));
        for (std::size_t t = 0; t < terms; ++t) {
          moved = fused(steps[t], load(element(b + 2 * (t + 1), j)), moved);
        }
        store(moved, element(b, j));
      }
    }
    for (std::size_t t = 0; t < terms; ++t) {
      diagonal = fused(steps[t], load(element(b, b + 2 * (t + 1))), diagonal);
    }
    store(diagonal, element(b, b));
  }
};

/// One order, of lanes that will have to move soon.
template <class Real, std::size_t Pairs>
STRAINWAVE_KERNEL void follow_early(const RippleFrames<Real, Pairs>& frames, std::size_t a,
                                    LaneMask<Real> lanes) {
  frames.follow(a, Real(0.5), lanes);
}

/// One order of each lane, where it has gone too far.
template <class Real, std::size_t Pairs>
STRAINWAVE_KERNEL void follow_now(const RippleFrames<Real, Pairs>& frames, LaneMask<Real> lanes) {
  for (std::size_t a = 0; a < frames.memory.order_count; ++a) {
    lanes = lanes & !frames.follow(a, Real(1), lanes);
  }
}

#undef STRAINWAVE_KERNEL
#undef STRAINWAVE_INLINE
