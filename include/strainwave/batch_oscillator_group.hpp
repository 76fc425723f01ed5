// SPDX-License-Identifier: Apache-2.0
/// @file batch_oscillator_group.hpp
/// States, covariance and output row of a group of lanes, and what a sample does to them.
///
/// Included by batch_oscillator.hpp within the namespace of each vector level.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers: they would take minutes to compile, for what only computes.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

/// The filter's numbers of one group of lanes, in registers as far as there are any.
template <class Real, std::size_t Orders, bool SecondIsDouble>
struct OscillatorGroup {
  using L = Lanes<Real>;
  using Mask = LaneMask<Real>;
  using Memory = OscillatorLanes<Real, Orders>;
  static constexpr std::size_t states = 2 * Orders;
  static constexpr std::size_t elements = states * (states + 1) / 2;

  L x[states];
  L p[elements];
  L c[states];
  L pending_rad;
  L travel_rad;
  L last_speed_rad_s;
  L smoothed_speed_rad_s;
  L last_torque_Nm;

  template <std::size_t I, std::size_t J>
  static constexpr std::size_t at = I >= J ? I * (I + 1) / 2 + J : J * (J + 1) / 2 + I;

  template <std::size_t... I>
  STRAINWAVE_INLINE static void load_rows(L* to, const Real (*from)[block_width<Real>],
                                          std::size_t lane, std::index_sequence<I...>) {
    ((to[I] = L::load(from[I] + lane)), ...);
  }
  template <std::size_t... I>
  STRAINWAVE_INLINE static void store_rows(const L* from, Real (*to)[block_width<Real>],
                                           std::size_t lane, std::index_sequence<I...>) {
    (from[I].store(to[I] + lane), ...);
  }

  STRAINWAVE_INLINE void load(const Memory& memory, std::size_t lane) {
    load_rows(x, memory.states_Nm, lane, std::make_index_sequence<states>{});
    load_rows(p, memory.covariance_Nm2, lane, std::make_index_sequence<elements>{});
    load_rows(c, memory.output, lane, std::make_index_sequence<states>{});
    pending_rad = L::load(memory.pending_rotation_rad + lane);
    travel_rad = L::load(memory.travel_rad + lane);
    last_speed_rad_s = L::load(memory.last_speed_rad_s + lane);
    smoothed_speed_rad_s = L::load(memory.smoothed_speed_rad_s + lane);
    last_torque_Nm = L::load(memory.last_torque_Nm + lane);
  }

  STRAINWAVE_INLINE void store(Memory& memory, std::size_t lane) const {
    store_rows(x, memory.states_Nm, lane, std::make_index_sequence<states>{});
    store_rows(p, memory.covariance_Nm2, lane, std::make_index_sequence<elements>{});
    store_rows(c, memory.output, lane, std::make_index_sequence<states>{});
    pending_rad.store(memory.pending_rotation_rad + lane);
    travel_rad.store(memory.travel_rad + lane);
    last_speed_rad_s.store(memory.last_speed_rad_s + lane);
    smoothed_speed_rad_s.store(memory.smoothed_speed_rad_s + lane);
    last_torque_Nm.store(memory.last_torque_Nm + lane);
  }

  // ---- output row -------------------------------------------------------------------------------

  template <std::size_t A, bool Reduced>
  STRAINWAVE_INLINE static CosSin<L> cos_sin_of(L angle_rad, const bool* slow) {
    if constexpr (!Reduced) {
      return cos_sin_of_radians(angle_rad);
    } else {
      return A > 0 && slow[A] ? cos_sin_small(angle_rad) : cos_sin_reduced(angle_rad);
    }
  }
  /// turned() of oscillator_state.hpp, without its correction of the length.
  template <std::size_t A, bool Reduced>
  STRAINWAVE_INLINE void turn_order(const Memory& memory, std::size_t lane, L rotation_rad,
                                    const bool* slow, L* now) const {
    if constexpr (SecondIsDouble && A == 1) {
      now[2] = fused_minus(now[1], now[1], now[0] * now[0]);
      const L half = now[0] * now[1];
      now[3] = half + half;
    } else {
      const L before = c[2 * A];
      const L angle_rad = L::load(memory.order[A] + lane) * rotation_rad;
      const CosSin<L> turn = cos_sin_of<A, Reduced>(angle_rad, slow);
      now[2 * A] = fused_minus(c[2 * A + 1], turn.sine, before * turn.cosine);
      now[2 * A + 1] = fused(before, turn.sine, c[2 * A + 1] * turn.cosine);
    }
  }
  /// The output row after a rotation of the motor; `now` may be the row itself.
  template <bool Reduced, std::size_t... A>
  STRAINWAVE_INLINE void turn_orders(const Memory& memory, std::size_t lane, L rotation_rad,
                                     const bool* slow, L* now,
                                     std::index_sequence<A...> /*orders*/) const {
    (turn_order<A, Reduced>(memory, lane, rotation_rad, slow, now), ...);
  }

  /// Puts the length of the output row back to 1 to first order: rounding would let it drift.  An
  /// order that a lane does not have stays at 0.
  template <std::size_t... A>
  STRAINWAVE_INLINE void correct_length(std::index_sequence<A...>) {
    (correct_order(c[2 * A], c[2 * A + 1]), ...);
  }
  STRAINWAVE_INLINE static void correct_order(L& cosine, L& sine) {
    const L length = fused(sine, sine, cosine * cosine);
    const L scale = fused_minus(length, L(Real(0.5)), L(Real(1.5)));
    cosine = scale * cosine;
    sine = scale * sine;
  }

  template <std::size_t... I>
  STRAINWAVE_INLINE void take_all(const L* now, std::index_sequence<I...>) {
    ((c[I] = now[I]), ...);
  }

  [[nodiscard]] STRAINWAVE_INLINE Mask is_moving(const Memory& memory, std::size_t lane) const {
    return (absolute(travel_rad) >= L::load(memory.minimum_travel_rad + lane)) &
           (absolute(smoothed_speed_rad_s) >= L::load(memory.minimum_speed_rad_s + lane));
  }
  /// Whether no angle has to be reduced, and no order turns half a cycle.
  [[nodiscard]] STRAINWAVE_INLINE static Mask is_usual_rotation(const Memory& memory,
                                                                std::size_t lane, L rotation_rad) {
    return absolute(L::load(memory.usual_order + lane) * rotation_rad) <=
           L(detail::largest_reduced_rad<Real>);
  }
  STRAINWAVE_INLINE void smooth_speed(const Memory& memory, std::size_t lane) {
    smoothed_speed_rad_s = smoothed_speed_rad_s + L::load(memory.speed_share + lane) *
                                                      (last_speed_rad_s - smoothed_speed_rad_s);
  }

  // ---- filter -----------------------------------------------------------------------------------

  // Sums of products order by order: a chain waits for each of its products, and sums of two
  // numbers are made by other units.

  template <std::size_t... A>
  STRAINWAVE_INLINE static L product(const L* a, const L* b, L start, std::index_sequence<A...>) {
    L sum = fused(a[1], b[1], fused(a[0], b[0], start));
    ((sum = A == 0 ? sum : sum + fused(a[2 * A + 1], b[2 * A + 1], a[2 * A] * b[2 * A])), ...);
    return sum;
  }
  /// Row I of P C'.
  template <std::size_t I, std::size_t... A>
  STRAINWAVE_INLINE L projected(const L* row, std::index_sequence<A...>) const {
    L sum = fused(p[at<I, 1>], row[1], p[at<I, 0>] * row[0]);
    ((sum = A == 0
                ? sum
                : sum + fused(p[at<I, 2 * A + 1>], row[2 * A + 1], p[at<I, 2 * A>] * row[2 * A])),
     ...);
    return sum;
  }
  template <std::size_t... I>
  STRAINWAVE_INLINE void project(const L* row, L* pc, std::index_sequence<I...>) const {
    ((pc[I] = projected<I>(row, std::make_index_sequence<Orders>{})), ...);
  }
  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE void update_row(L gain, const L* pc, std::index_sequence<J...>) {
    ((p[at<I, J>] = fused_minus(gain, pc[J], p[at<I, J>])), ...);
  }
  template <std::size_t I>
  STRAINWAVE_INLINE void update_state(const L* pc, L per_variance, L innovation_Nm, L noise_Nm2) {
    const L gain = pc[I] * per_variance;
    x[I] = fused(gain, innovation_Nm, x[I]);
    p[at<I, I>] = p[at<I, I>] + noise_Nm2;
    update_row<I>(gain, pc, std::make_index_sequence<I + 1>{});
  }
  template <bool OneSample, std::size_t... A>
  STRAINWAVE_INLINE void update(const Memory& memory, std::size_t lane, const L* pc, L per_variance,
                                L innovation_Nm, L samples, std::index_sequence<A...>) {
    (update_order<A, OneSample>(memory, lane, pc, per_variance, innovation_Nm, samples), ...);
  }
  template <std::size_t A, bool OneSample>
  STRAINWAVE_INLINE void update_order(const Memory& memory, std::size_t lane, const L* pc,
                                      L per_variance, L innovation_Nm, L samples) {
    const L once_Nm2 = L::load(memory.process_noise_variance_Nm2[A] + lane);
    const L noise_Nm2 = OneSample ? once_Nm2 : samples * once_Nm2;
    update_state<2 * A>(pc, per_variance, innovation_Nm, noise_Nm2);
    update_state<2 * A + 1>(pc, per_variance, innovation_Nm, noise_Nm2);
  }

  // ---- what is rare -----------------------------------------------------------------------------

  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE void reset_row(const Memory& memory, std::size_t lane, Mask reset,
                                   std::index_sequence<J...>) {
    ((p[at<I, J>] =
          select(reset, I == J ? L::load(memory.initial_variance_Nm2[I / 2] + lane) : L(Real(0)),
                 p[at<I, J>])),
     ...);
  }
  /// C P C' < 0 or not finite: rounding has cost P its sign.  The states are kept.
  template <std::size_t... I>
  STRAINWAVE_INLINE void reset_covariance(const Memory& memory, std::size_t lane, Mask reset,
                                          std::index_sequence<I...>) {
    (reset_row<I>(memory, lane, reset, std::make_index_sequence<I + 1>{}), ...);
  }
  /// No gain but where the mask says so, whatever the other lanes hold.
  template <std::size_t... I>
  STRAINWAVE_INLINE static void keep(Mask updated, L* pc, std::index_sequence<I...>) {
    ((pc[I] = select(updated, pc[I], L(Real(0)))), ...);
  }

  template <std::size_t A>
  [[nodiscard]] STRAINWAVE_INLINE L larger_variance() const {
    return larger(p[at<2 * A, 2 * A>], p[at<2 * A + 1, 2 * A + 1>]);
  }
  template <std::size_t... A>
  [[nodiscard]] STRAINWAVE_INLINE Mask beyond_limit(const Memory& memory, std::size_t lane,
                                                    std::index_sequence<A...>) const {
    return ((larger_variance<A>() > L::load(memory.variance_limit_Nm2[A] + lane)) | ...);
  }
  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE void scale_state(L scale, std::index_sequence<J...>) {
    ((p[at<I, J>] = p[at<I, J>] * scale), ...);
    p[at<I, I>] = p[at<I, I>] * scale;
  }
  /// limit_variance() of oscillator_state.hpp for one order.
  template <std::size_t A>
  STRAINWAVE_INLINE void limit_order(const Memory& memory, std::size_t lane, Mask learned) {
    const L limit = L::load(memory.variance_limit_Nm2[A] + lane);
    const L variance = larger_variance<A>();
    const Mask beyond = (variance > limit) & learned;
    const L scale = select(beyond, square_root(limit / variance), L(Real(1)));
    scale_state<2 * A>(scale, std::make_index_sequence<states>{});
    scale_state<2 * A + 1>(scale, std::make_index_sequence<states>{});
  }
  template <std::size_t... A>
  STRAINWAVE_INLINE void limit_variance(const Memory& memory, std::size_t lane, Mask learned,
                                        std::index_sequence<A...>) {
    (limit_order<A>(memory, lane, learned), ...);
  }
};

#undef STRAINWAVE_INLINE
