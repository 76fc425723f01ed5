// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_kernel.hpp
/// step() of the ripple filter on lanes, a tile at a time.
///
/// Included by batch_ripple.hpp within the namespace of each vector level.  The covariance is in
/// memory, its lower triangle alone; what runs over it is written out.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers, as the published filter's kernel.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline
#define STRAINWAVE_KERNEL \
  [[gnu::noinline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

template <class Real>
STRAINWAVE_INLINE Lanes<Real> one_where(LaneMask<Real> mask) {
  return select(mask, Lanes<Real>(Real(1)), Lanes<Real>(Real(0)));
}

/// How often an order's lanes move their frames together.
inline constexpr std::size_t samples_between_moves = 16;

/// One group of lanes at one sample.
template <class Real, std::size_t Pairs>
struct RippleGroup {
  using L = Lanes<Real>;
  using Mask = LaneMask<Real>;
  using Wholes = WholeLanes<Real>;
  using Memory = RippleLanes<Real, Pairs>;
  using Frames = RippleFrames<Real, Pairs>;
  static constexpr std::size_t coefficients = 2 * Pairs;

  L torque_Nm;
  L expected_Nm;
  L interval_s;
  Wholes turns;
  Wholes fraction;
  L rotation_rad;
  L speed_rad_s;
  L smoothed_speed_rad_s;

  L cosines[Pairs];  ///< of each order
  L sines[Pairs];
  L factors[ripple_factors];
  L h[coefficients];
  L row[coefficients];

  L ripple_Nm;
  L clean_Nm;
  L all_removed_Nm;
  L innovation_Nm;
  L variance_Nm2;
  L smallest_share;  ///< of its process noise that a pair is given

  // NOLINTBEGIN(cppcoreguidelines-avoid-const-or-ref-data-members): a group lives for one sample.
  Memory& memory;
  const RippleTile<Real>& tile;
  const RippleAlone& alone;
  // NOLINTEND(cppcoreguidelines-avoid-const-or-ref-data-members)
  std::size_t lane;
  std::size_t k;

  Mask usual;
  Mask moving;
  Mask above_nyquist;
  Mask limited;

  static constexpr auto by_pair = std::make_index_sequence<Pairs>{};
  static constexpr auto by_coefficient = std::make_index_sequence<coefficients>{};

  STRAINWAVE_INLINE RippleGroup(Memory& memory_of, const RippleTile<Real>& tile_of,
                                const RippleAlone& alone_of, std::size_t lane_of, std::size_t k_of)
      : memory(memory_of), tile(tile_of), alone(alone_of), lane(lane_of), k(k_of) {}

  STRAINWAVE_INLINE static Mask none() { return L(Real(1)) <= L(Real(0)); }
  STRAINWAVE_INLINE L load(const Real* of_row) const { return L::load(of_row + lane); }
  STRAINWAVE_INLINE void store(L value, Real* of_row) const { value.store(of_row + lane); }

  // ---- sample -----------------------------------------------------------------------------------

  STRAINWAVE_INLINE void take_sample() {
    const std::size_t place = k * block_width<Real> + lane;
    torque_Nm = L::load(tile.measured_torque_Nm + place);
    turns = load_whole<Real>(tile.turns + place);
    fraction = load_whole<Real>(tile.fraction + place);
    interval_s = L::load(tile.interval_s + k * tile.interval_stride + lane);
    expected_Nm = L::load(tile.expected_torque_Nm + k * tile.expected_stride + lane);
  }

  /// Rotation, speeds, and whether the lane goes on as usual.
  STRAINWAVE_INLINE void take_phase() {
    const Wholes last_turns = load_whole<Real>(memory.last_turns + lane);
    const Wholes last_fraction = load_whole<Real>(memory.last_fraction + lane);
    const L per_unit = Real(1) / Real(4294967296.0);
    const L turned = to_lanes<Real>(wrapped<Real>(fraction - last_fraction)) * per_unit;
    const L on_record = to_lanes<Real>(turns - last_turns) +
                        (to_lanes<Real>(fraction) - to_lanes<Real>(last_fraction)) * per_unit;
    rotation_rad = turned * L(two_pi<Real>);
    const L last_interval_s = load(memory.interval_s);
    if (!((last_interval_s <= interval_s) & (interval_s <= last_interval_s)).all()) {
      take_interval();
    }
    const L typical_s = load(memory.typical_interval_s);
    const L largest_Nm = Real(largest_usable_torque_Nm);
    const L old_speed_rad_s = load(memory.speed_rad_s);
    const L longest_s = static_cast<Real>(detail::longest_interval_s);
    const L gap_s = L(static_cast<Real>(detail::least_gap)) * typical_s;
    // In pairs: each comparison of a long row of them would wait for the one before.
    const Mask sound = (absolute(torque_Nm) <= largest_Nm) & (absolute(expected_Nm) <= largest_Nm);
    const Mask in_time =
        (interval_s > L(Real(0))) & (interval_s <= select(gap_s < longest_s, gap_s, longest_s));
    const Mask reachable = (absolute(on_record - turned) < L(Real(0.25))) &
                           (absolute(rotation_rad) <=
                            L(static_cast<Real>(detail::largest_motor_speed_rad_s)) * interval_s);
    const Mask stands = (absolute(rotation_rad) <= L(Real(0))) &
                        (interval_s < L(static_cast<Real>(detail::longest_hold_s)));
    const L measured_Nm = load(memory.measured_Nm);
    const Mask repeats = (torque_Nm <= measured_Nm) & (measured_Nm <= torque_Nm);
    const Mask held =
        stands & (repeats & (absolute(old_speed_rad_s) * interval_s >=
                             L(static_cast<Real>(detail::least_travel_of_a_held_sample_rad))));
    usual = ((load(memory.in_step) > L(Real(0))) & sound) & (in_time & reachable) & !held;
    const L speed_now_rad_s = rotation_rad * load(memory.per_interval);
    speed_rad_s =
        fused(load(memory.speed_share), speed_now_rad_s - old_speed_rad_s, old_speed_rad_s);
    const L old_smoothed_rad_s = load(memory.smoothed_speed_rad_s);
    smoothed_speed_rad_s = fused(load(memory.smoothed_speed_share),
                                 speed_now_rad_s - old_smoothed_rad_s, old_smoothed_rad_s);
    moving = absolute(smoothed_speed_rad_s) >= load(memory.minimum_speed_rad_s);
    above_nyquist = absolute(load(memory.highest_order) * rotation_rad) > L(pi<Real>);
  }

  /// What of an interval is divided.
  STRAINWAVE_INLINE void take_interval() const {
    store(interval_s, memory.interval_s);
    store(L(Real(1)) / interval_s, memory.per_interval);
    store(interval_s / (interval_s + L(static_cast<Real>(detail::speed_term_smoothing_s))),
          memory.speed_share);
    store(interval_s / (interval_s + L(static_cast<Real>(detail::speed_smoothing_s))),
          memory.smoothed_speed_share);
    store(interval_s / (interval_s + L(static_cast<Real>(detail::load_smoothing_s))),
          memory.load_share);
  }

  /// Sends lanes to do this sample alone.
  STRAINWAVE_INLINE void send(Mask lanes) const {
    store(one_where(lanes), memory.alone);
    alone.leave(alone.block, lane, L::count, k);
  }

  // ---- regressors -------------------------------------------------------------------------------

  [[nodiscard]] STRAINWAVE_INLINE Wholes fraction_in_step(std::size_t a) const {
    return tile.order_fraction[a] != nullptr
               ? load_whole<Real>(tile.order_fraction[a] + k * block_width<Real> + lane)
               : wrapped<Real>(fraction * load_whole<Real>(memory.numerator[a] + lane));
  }

  STRAINWAVE_INLINE void find_own_angles() {
    for (std::size_t a = 0; a < memory.order_count; ++a) {
      store_whole<Real>(fraction_in_step(a), memory.order_fraction[a] + lane);
    }
    store(rotation_rad, memory.rotation_rad);
    store(speed_rad_s, memory.new_speed_rad_s);
    store(one_where(!usual), memory.alone);
    alone.find_angles(alone.block, lane, L::count, k);
    rotation_rad = load(memory.rotation_rad);
  }

  [[nodiscard]] STRAINWAVE_INLINE Wholes order_fraction(std::size_t a) const {
    return memory.any_own_angle ? load_whole<Real>(memory.order_fraction[a] + lane)
                                : fraction_in_step(a);
  }

  STRAINWAVE_INLINE void find_waves() {
    for (std::size_t a = 0; a < memory.order_count; ++a) {
      if (memory.orders[a].in_series) {
        cosines[a] = fused_minus(sines[a - 1], sines[0], cosines[a - 1] * cosines[0]);
        sines[a] = fused(cosines[a - 1], sines[0], sines[a - 1] * cosines[0]);
      } else {
        const CosSin<L> wave = cos_sin_of_fraction<Real>(order_fraction(a));
        cosines[a] = wave.cosine;
        sines[a] = wave.sine;
      }
    }
  }

  STRAINWAVE_INLINE void find_factors() {
    const L speed = absolute(speed_rad_s);
    factors[0] = Real(1);
    factors[1] = load(memory.load_factor);
    factors[2] = speed * load(memory.per_reference_speed);
    factors[3] = memory.any_direction ? speed_rad_s / (speed + L(Real(1))) : L(Real(0));
    factors[4] = Real(0);
  }

  // ---- frame ------------------------------------------------------------------------------------

  template <std::size_t... P>
  STRAINWAVE_INLINE void find_offsets(L* offsets, std::index_sequence<P...>) const {
    ((offsets[P] = factors[memory.factor_of[P]] - load(memory.frames[P])), ...);
  }
  template <std::size_t... P>
  [[nodiscard]] STRAINWAVE_INLINE Mask is_any_too_far(const L* offsets,
                                                      std::index_sequence<P...>) const {
    return ((absolute(offsets[P]) > L(memory.widest_offset[P])) | ...);
  }
  template <std::size_t P>
  STRAINWAVE_INLINE void enter_pair(L offset) {
    h[2 * P] = offset * cosines[memory.order_of[P]];
    h[2 * P + 1] = offset * sines[memory.order_of[P]];
  }
  template <std::size_t... P>
  STRAINWAVE_INLINE void enter_pairs(const L* offsets, std::index_sequence<P...>) {
    (enter_pair<P>(offsets[P]), ...);
  }

  /// A copy, so that what is called does not know of the group: it would have to be in memory.
  struct FactorRow {
    L factors[ripple_factors];
  };
  [[nodiscard]] STRAINWAVE_INLINE FactorRow factors_now() const {
    return {{factors[0], factors[1], factors[2], factors[3], factors[4]}};
  }

  /// follow() and enter_frame() of ripple_covariance.hpp.  Lanes that will have to move soon do so
  /// together, an order at a time, at samples that none of them has a part in choosing: one after
  /// the other they would move at every few samples, and a lane shall not depend on another one.
  STRAINWAVE_INLINE void enter_frame() {
    const std::size_t turn = (tile.first_sample + k) % samples_between_moves;
    if (turn < memory.order_count && memory.orders[turn].terms > 0) {
      const FactorRow now = factors_now();
      follow_early(Frames{memory, lane, now.factors}, turn, usual);
    }
    L offsets[Pairs];
    find_offsets(offsets, by_pair);
    if ((is_any_too_far(offsets, by_pair) & usual).any()) [[unlikely]] {
      const FactorRow now = factors_now();
      follow_now(Frames{memory, lane, now.factors}, usual);
      find_offsets(offsets, by_pair);
    }
    enter_pairs(offsets, by_pair);
  }

  STRAINWAVE_INLINE void add_to(Real* numbers, L value) const {
    store(load(numbers) + value, numbers);
  }

  // ---- torque without ripple --------------------------------------------------------------------

  template <std::size_t... I>
  STRAINWAVE_INLINE void load_rows(const Real (*rows)[block_width<Real>], L* numbers,
                                   std::index_sequence<I...>) const {
    ((numbers[I] = load(rows[I])), ...);
  }
  template <std::size_t... P>
  STRAINWAVE_INLINE L sum_with_h(const L* numbers, std::index_sequence<P...>) const {
    L sums[4] = {Real(0), Real(0), Real(0), Real(0)};
    ((sums[2 * P % 4] = fused(h[2 * P], numbers[2 * P], sums[2 * P % 4]),
      sums[(2 * P + 1) % 4] = fused(h[2 * P + 1], numbers[2 * P + 1], sums[(2 * P + 1) % 4])),
     ...);
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
  template <std::size_t... P>
  STRAINWAVE_INLINE void leave_removed(L* numbers, std::index_sequence<P...>) const {
    ((numbers[2 * P] = load(memory.kept[memory.order_of[P]]) * numbers[2 * P],
      numbers[2 * P + 1] = load(memory.kept[memory.order_of[P]]) * numbers[2 * P + 1]),
     ...);
  }

  /// The ripple that is removed, and torque without it and without any.
  STRAINWAVE_INLINE void remove_ripple() {
    L coefficients_Nm[coefficients];
    load_rows(memory.coefficients_Nm, coefficients_Nm, by_coefficient);
    const L all_Nm = sum_with_h(coefficients_Nm, by_pair);
    L kept_Nm = Real(0);
    if (memory.any_kept) {
      leave_removed(coefficients_Nm, by_pair);
      kept_Nm = sum_with_h(coefficients_Nm, by_pair);
    }
    ripple_Nm = all_Nm - kept_Nm;
    if (memory.any_own_angle) {
      ripple_Nm = ripple_Nm + load(memory.frozen_Nm);
    }
    clean_Nm = torque_Nm - ripple_Nm;
    all_removed_Nm = clean_Nm - kept_Nm;
    innovation_Nm = all_removed_Nm - expected_Nm - load(memory.torque_state_Nm);
  }

  // ---- covariance, written out ------------------------------------------------------------------

  template <std::size_t I, std::size_t J>
  STRAINWAVE_INLINE void project_element(L* sums) const {
    const L element = load(memory.covariance_Nm2[detail::lane_element(I, J)]);
    if constexpr (I == J) {
      sums[I] = element * h[I];
    } else {
      sums[I] = fused(element, h[J], sums[I]);
      sums[J] = fused(element, h[I], sums[J]);
    }
  }
  template <std::size_t D, std::size_t... J>
  STRAINWAVE_INLINE void project_diagonal(L* sums, std::index_sequence<J...>) const {
    (project_element<J + D, J>(sums), ...);
  }
  /// P h; each element is read once.  By diagonals, so that no sum is added to twice in a row: it
  /// would be waited for.
  template <std::size_t... D>
  STRAINWAVE_INLINE void project(L* sums, std::index_sequence<D...>) const {
    (project_diagonal<D>(sums, std::make_index_sequence<coefficients - D>{}), ...);
  }

  /// T's row after the measurement, see measure_torque(); puts P h with T into `row`.
  template <std::size_t... I>
  STRAINWAVE_INLINE void measure_torque(L left, const L* ripple, const L* torque,
                                        std::index_sequence<I...>) {
    ((row[I] = ripple[I] + torque[I],
      store(fused(left, row[I], L(Real(0)) - ripple[I]), memory.torque_row_Nm2[I])),
     ...);
  }

  // ---- update -----------------------------------------------------------------------------------

  /// jump_variance() of ripple_state.hpp, where the motor moves.
  [[nodiscard]] STRAINWAVE_INLINE L jump_variance(L ripple_variance_Nm2) const {
    const L scale_Nm = load(memory.innovation_scale_Nm);
    const L limit_Nm2 = L(static_cast<Real>(detail::robust_limit * detail::robust_limit)) *
                        larger(scale_Nm * scale_Nm, ripple_variance_Nm2);
    const L square_Nm2 = innovation_Nm * innovation_Nm;
    const Mask beyond = (square_Nm2 > limit_Nm2) & moving;
    if (!beyond.any()) {
      return L(Real(0));
    }
    const L ratio = square_Nm2 / limit_Nm2;
    const L most = Real(1e12);
    const L excess = select(ratio < most, ratio, most) - L(Real(1));
    return select(beyond, variance_Nm2 * excess, L(Real(0)));
  }

  /// The Kalman update of update_of().
  STRAINWAVE_INLINE void update() {
    const L noise_Nm2 = load(memory.noise_Nm2);
    L torque_row_Nm2[coefficients];
    load_rows(memory.torque_row_Nm2, torque_row_Nm2, by_coefficient);
    const L longest_s = static_cast<Real>(detail::longest_torque_walk_s);
    const L walked_s = select(interval_s < longest_s, interval_s, longest_s);
    const L torque_variance_Nm2 =
        fused(load(memory.walk_Nm2_per_s), walked_s, load(memory.torque_variance_Nm2));
    L projected_Nm2[coefficients];
    project(projected_Nm2, by_coefficient);
    const L ripple_variance_Nm2 = sum_with_h(projected_Nm2, by_pair);
    const L shared_Nm2 = sum_with_h(torque_row_Nm2, by_pair);
    const L with_torque_Nm2 = torque_variance_Nm2 + shared_Nm2;
    const L rest_Nm2 = noise_Nm2 + ripple_variance_Nm2 + shared_Nm2;
    variance_Nm2 = rest_Nm2 + with_torque_Nm2;
    const Mask healthy = (variance_Nm2 <= L(std::numeric_limits<Real>::max())) &
                         (variance_Nm2 > L(Real(0))) &
                         (ripple_variance_Nm2 > L(Real(0)) - noise_Nm2);
    const Mask reset = usual & !healthy;
    if (reset.any()) [[unlikely]] {
      send(reset);
      usual = usual & healthy;
    }
    const L jump_Nm2 = jump_variance(ripple_variance_Nm2);
    const L per_variance = L(Real(1)) / (variance_Nm2 + jump_Nm2);
    // Before the quotient is there to go on with.
    L gained_Nm2[Pairs];
    find_noise(gained_Nm2);
    track_scale();
    finish();
    const L state_Nm = load(memory.torque_state_Nm);
    store(fused((with_torque_Nm2 + jump_Nm2) * per_variance, innovation_Nm, state_Nm),
          memory.torque_state_Nm);
    const L left = rest_Nm2 * per_variance;
    store(fused_minus(left, rest_Nm2, noise_Nm2 + ripple_variance_Nm2), memory.torque_variance_Nm2);
    measure_torque(left, projected_Nm2, torque_row_Nm2, by_coefficient);
    if (moving.any()) {
      const L learning = select(moving, per_variance, L(Real(0)));
      learn(learning * innovation_Nm, by_coefficient);
      measure_pairs(learning, gained_Nm2, by_pair);
    }
  }

  /// The coefficients' part of the update.
  template <std::size_t... I>
  STRAINWAVE_INLINE void learn(L gain_per_row, std::index_sequence<I...>) const {
    (store(fused(row[I], gain_per_row, load(memory.coefficients_Nm[I])), memory.coefficients_Nm[I]),
     ...);
  }

  /// track_scale() of ripple_state.hpp.
  STRAINWAVE_INLINE void track_scale() const {
    const L old_Nm = load(memory.innovation_scale_Nm);
    const L rotation = absolute(rotation_rad);
    const L travel_rad = select(rotation < L(Real(3)), rotation, L(Real(3)));
    const L beyond = one_where(absolute(innovation_Nm) > old_Nm);
    const L change = L(static_cast<Real>(detail::scale_rate_per_rad)) * travel_rad *
                     (beyond - L(static_cast<Real>(detail::share_beyond_scale)));
    const L scale_Nm = old_Nm * fused(change, fused(L(Real(0.5)), change, L(Real(1))), L(Real(1)));
    store(select(moving, larger(scale_Nm, load(memory.least_scale_Nm)), old_Nm),
          memory.innovation_scale_Nm);
  }

  // ---- process noise ----------------------------------------------------------------------------

  /// let_ripple_walk() of ripple_state.hpp, without a gap: variance that each order gains, shared
  /// among its pairs.
  STRAINWAVE_INLINE void find_noise(L* gained_Nm2) const {
    const L square_rad2 = rotation_rad * rotation_rad;
    const L per_square = load(memory.per_memory_square);
    const L share_all = square_rad2 * per_square;
    const L share = select(share_all < L(Real(1)), share_all, L(Real(1)));
    const L walk_Nm2 = L(Real(2)) * load(memory.walk_Nm2_per_s) * interval_s;
    const L noise_Nm2 = L(Real(2)) * load(memory.noise_Nm2) * share;
    const L walk_per_square_Nm2 = select(share > L(Real(0)), walk_Nm2 * per_square, L(Real(0)));
    const L white_Nm2 = fused(L(Real(0.25)) * walk_Nm2, share, noise_Nm2);
    for (std::size_t a = 0; a < memory.order_count; ++a) {
      const RippleOrderLayout& layout = memory.orders[a];
      const L order = load(memory.order[a]);
      const L per_order = load(memory.per_order[a]);
      const L square = (order * order) * square_rad2;
      L bent = fused(square, L(Real(4.99873192e-07)), L(Real(1.88781908e-06)));
      bent = fused(square, bent, L(Real(1.85362645e-04)));
      bent = fused(square, bent, L(Real(4.12392359e-03)));
      bent = fused(square, bent, L(Real(8.33619094e-02)));
      bent = fused(square, bent, L(Real(1)));
      L each_Nm2 = fused((per_order * per_order) * walk_per_square_Nm2, bent, noise_Nm2);
      each_Nm2 = select(square > L(pi<Real> * pi<Real>), white_Nm2, each_Nm2);
      if (layout.terms > 0) {
        L weight = Real(1);
        for (std::size_t t = 0; t < layout.terms; ++t) {
          const L factor = factors[static_cast<std::size_t>(layout.factors[t])];
          weight = fused(factor, factor, weight);
        }
        each_Nm2 = each_Nm2 * reciprocal(weight);
      }
      gained_Nm2[a] = select(moving, each_Nm2, L(Real(0)));
    }
  }

  // ---- coefficients' block, written out by pairs ------------------------------------------------

  /// A row of P - P h h'P / s up to the pair's own columns.
  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE void measure_row([[maybe_unused]] L gain, std::index_sequence<J...>) const {
    (store(measured<I, J>(gain), memory.covariance_Nm2[detail::lane_element(I, J)]), ...);
  }
  template <std::size_t I, std::size_t J>
  [[nodiscard]] STRAINWAVE_INLINE L measured(L gain) const {
    return fused_minus(gain, row[J], load(memory.covariance_Nm2[detail::lane_element(I, J)]));
  }

  /// share_of_noise() of ripple_covariance.hpp.
  [[nodiscard]] STRAINWAVE_INLINE L share_of_noise(L variances_Nm2, L half_per_limit) {
    const L share = fused_minus(variances_Nm2, half_per_limit, L(Real(1)));
    smallest_share = smaller(share, smallest_share);
    return larger(share, L(Real(0)));
  }

  /// A pair's rows after the measurement, and its process noise, add_noise() of
  /// ripple_covariance.hpp, while they are at hand.  From the last pair to the first: what an
  /// order's further pairs have gained, `of_further_Nm2`, its first one gains as well.
  template <std::size_t P>
  STRAINWAVE_INLINE void measure_pair(L learning, const L* gained_Nm2, L& of_further_Nm2) {
    constexpr std::size_t i = 2 * P;
    const auto factor_of = static_cast<RippleFactor>(memory.factor_of[P]);
    if (factor_of == RippleFactor::none) {
      return;
    }
    constexpr auto before = std::make_index_sequence<i>{};
    const L cosine_gain = row[i] * learning;
    const L sine_gain = row[i + 1] * learning;
    measure_row<i>(cosine_gain, before);
    measure_row<i + 1>(sine_gain, before);
    store(measured<i + 1, i>(sine_gain), memory.covariance_Nm2[detail::lane_element(i + 1, i)]);
    const L cosine_Nm2 = measured<i, i>(cosine_gain);
    const L sine_Nm2 = measured<i + 1, i + 1>(sine_gain);
    const L share = share_of_noise(cosine_Nm2 + sine_Nm2, load(memory.half_per_limits[P]));
    L its_Nm2 = gained_Nm2[memory.order_of[P]] * share;
    if (factor_of == RippleFactor::one) {
      its_Nm2 = its_Nm2 + of_further_Nm2;
      of_further_Nm2 = Real(0);
    } else {
      const std::size_t first = 2 * memory.first_of[P];
      const L factor = load(memory.frames[P]);
      const L with_first_Nm2 = factor * its_Nm2;
      add_to(memory.covariance_Nm2[detail::lane_element(i, first)], with_first_Nm2);
      add_to(memory.covariance_Nm2[detail::lane_element(i + 1, first + 1)], with_first_Nm2);
      of_further_Nm2 = fused(factor, with_first_Nm2, of_further_Nm2);
    }
    store(cosine_Nm2 + its_Nm2, memory.covariance_Nm2[detail::lane_element(i, i)]);
    store(sine_Nm2 + its_Nm2, memory.covariance_Nm2[detail::lane_element(i + 1, i + 1)]);
  }
  template <std::size_t... P>
  STRAINWAVE_INLINE void measure_pairs(L learning, const L* gained_Nm2, std::index_sequence<P...>) {
    L of_further_Nm2 = Real(0);
    smallest_share = Real(1);
    (measure_pair<Pairs - 1 - P>(learning, gained_Nm2, of_further_Nm2), ...);
    limited = moving & (smallest_share <= L(Real(0)));
  }

  // ---- end --------------------------------------------------------------------------------------

  /// finish_learning() of ripple_sample.hpp, and what the sample leaves behind.
  STRAINWAVE_INLINE void finish() const {
    store_whole<Real>(turns, memory.last_turns + lane);
    store_whole<Real>(fraction, memory.last_fraction + lane);
    store(speed_rad_s, memory.speed_rad_s);
    store(smoothed_speed_rad_s, memory.smoothed_speed_rad_s);
    store(torque_Nm, memory.measured_Nm);
    store(clean_Nm, memory.torque_Nm);
    store(all_removed_Nm, memory.torque_all_Nm);
    const L load_Nm = load(memory.load_Nm);
    const L now_Nm = fused(load(memory.load_share), all_removed_Nm - load_Nm, load_Nm);
    store(now_Nm, memory.load_Nm);
    const L load_ratio = now_Nm * load(memory.per_rated_torque);
    store(load_ratio * reciprocal(L(Real(1)) + absolute(load_ratio)), memory.load_factor);
    const L typical_s = load(memory.typical_interval_s);
    store(fused(interval_s - typical_s, L(Real(1) / Real(64)), typical_s),
          memory.typical_interval_s);
  }

  STRAINWAVE_INLINE void raise(Mask raised, std::size_t flag, L& status) const {
    const L one = one_where(raised & usual);
    store(load(memory.counts[flag]) + one, memory.counts[flag]);
    status = status + one * L(static_cast<Real>(mask(ripple_lane_flags[flag])));
  }

  STRAINWAVE_INLINE void put(RippleOutput output, L value) const {
    Real* const values = tile.outputs[static_cast<std::size_t>(output)];
    if (values != nullptr) {
      value.store(values + k * block_width<Real> + lane);
    }
  }

  STRAINWAVE_INLINE void put_all() const {
    put(RippleOutput::torque, clean_Nm);
    put(RippleOutput::ripple, ripple_Nm);
    put(RippleOutput::all_removed, all_removed_Nm);
    put(RippleOutput::state, load(memory.torque_state_Nm) + expected_Nm);
    put(RippleOutput::innovation, innovation_Nm);
    put(RippleOutput::variance, variance_Nm2);
    L status = Real(0);
    if ((((!moving) | above_nyquist | limited) & usual).any()) {
      raise(!moving, 0, status);
      raise(above_nyquist, 1, status);
      raise(limited, 2, status);
      memory.any_count = true;
    }
    if (tile.status != nullptr) {
      status.store(tile.status + k * block_width<Real> + lane);
    }
  }

  STRAINWAVE_INLINE void filter() {
    take_sample();
    take_phase();
    const Mask live = load(memory.live) > L(Real(0));
    const Mask unusual = live & !usual;
    if (unusual.any()) [[unlikely]] {
      send(unusual);
      if (!usual.any()) {
        alone.come_back(alone.block, lane, L::count, k);
        return;
      }
    }
    if (memory.any_own_angle) {
      find_own_angles();
    }
    find_waves();
    find_factors();
    limited = none();
    enter_frame();
    remove_ripple();
    update();
    put_all();
    const Mask left = live & !usual;
    if (left.any()) [[unlikely]] {
      store(one_where(left), memory.alone);
      alone.come_back(alone.block, lane, L::count, k);
    }
  }
};

/// A tile through all lanes of a block.
template <class Real, std::size_t Pairs>
STRAINWAVE_KERNEL void filter_ripple_tile(RippleLanes<Real, Pairs>& memory,
                                          const RippleTile<Real>& tile, const RippleAlone& alone) {
  using Group = RippleGroup<Real, Pairs>;
  for (std::size_t lane = 0; lane < block_width<Real>; lane += Lanes<Real>::count) {
    const RippleAhead<Real>* const ahead = lane == 0 ? tile.ahead : nullptr;
    for (std::size_t k = 0; k < tile.sample_count; ++k) {
      if (ahead != nullptr) {
        ahead->ask(tile.first_sample + 2 * tile_samples, k);
      }
      Group(memory, tile, alone, lane, k).filter();
    }
  }
}

#undef STRAINWAVE_KERNEL
#undef STRAINWAVE_INLINE
