// SPDX-License-Identifier: Apache-2.0
/// @file batch_oscillator_kernel.hpp
/// step() of the published filter on lanes, a tile at a time.
///
/// Included by batch_oscillator.hpp within the namespace of each vector level.  The usual sample,
/// from which every lane learns and about which nothing is to be said, has no branch taken; the
/// rest is told apart by masks.
// No guard and no includes: see lanes_each_level.hpp.

#define STRAINWAVE_INLINE [[gnu::always_inline]] inline

/// What has to be said about a sample, lane by lane.
template <class Real>
struct OscillatorEvents {
  LaneMask<Real> torque_usable;
  LaneMask<Real> expected_usable;
  LaneMask<Real> moving;
  LaneMask<Real> reset;
  LaneMask<Real> limited;
  LaneMask<Real> speed_usable;
  LaneMask<Real> above_nyquist;
};

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
  L needed_travel_rad;
  L samples_without_update;
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
    needed_travel_rad = L::load(memory.needed_travel_rad + lane);
    samples_without_update = L::load(memory.samples_without_update + lane);
    last_speed_rad_s = L::load(memory.last_speed_rad_s + lane);
    smoothed_speed_rad_s = L::load(memory.smoothed_speed_rad_s + lane);
    last_torque_Nm = L::load(memory.last_torque_Nm + lane);
  }

  STRAINWAVE_INLINE void store(Memory& memory, std::size_t lane) const {
    store_rows(x, memory.states_Nm, lane, std::make_index_sequence<states>{});
    store_rows(p, memory.covariance_Nm2, lane, std::make_index_sequence<elements>{});
    store_rows(c, memory.output, lane, std::make_index_sequence<states>{});
    pending_rad.store(memory.pending_rotation_rad + lane);
    needed_travel_rad.store(memory.needed_travel_rad + lane);
    samples_without_update.store(memory.samples_without_update + lane);
    last_speed_rad_s.store(memory.last_speed_rad_s + lane);
    smoothed_speed_rad_s.store(memory.smoothed_speed_rad_s + lane);
    last_torque_Nm.store(memory.last_torque_Nm + lane);
  }

  // ---- output row -------------------------------------------------------------------------------

  /// turned() of oscillator_state.hpp.
  template <std::size_t A, bool Small>
  STRAINWAVE_INLINE void turn_order(const Memory& memory, std::size_t lane, L* now) const {
    if constexpr (SecondIsDouble && A == 1) {
      now[2] = fused_minus(now[1], now[1], now[0] * now[0]);
      const L half = now[0] * now[1];
      now[3] = half + half;
    } else {
      const L angle_rad = L::load(memory.order[A] + lane) * pending_rad;
      const CosSin<L> turn = Small ? cos_sin_reduced(angle_rad) : cos_sin_of_radians(angle_rad);
      const L cosine = fused_minus(c[2 * A + 1], turn.sine, c[2 * A] * turn.cosine);
      const L sine = fused(c[2 * A], turn.sine, c[2 * A + 1] * turn.cosine);
      const L length = fused(sine, sine, cosine * cosine);
      const L scale = fused_minus(length, L(Real(0.5)), L(Real(1.5)));
      now[2 * A] = scale * cosine;
      now[2 * A + 1] = scale * sine;
    }
  }
  template <bool Small, std::size_t... A>
  STRAINWAVE_INLINE void turn_orders(const Memory& memory, std::size_t lane, L* now,
                                     std::index_sequence<A...>) const {
    (turn_order<A, Small>(memory, lane, now), ...);
  }
  STRAINWAVE_INLINE void output_now(const Memory& memory, std::size_t lane, L* now) const {
    const L largest_rad = L::load(memory.highest_order + lane) * absolute(pending_rad);
    if ((largest_rad <= L(largest_reduced_rad<Real>)).all()) [[likely]] {
      turn_orders<true>(memory, lane, now, std::make_index_sequence<Orders>{});
    } else {
      turn_orders<false>(memory, lane, now, std::make_index_sequence<Orders>{});
    }
  }

  /// Where the mask says so, the output row from here on and no rotation since it.
  template <std::size_t... I>
  STRAINWAVE_INLINE void take_output(Mask taken, const L* now, std::index_sequence<I...>) {
    ((c[I] = select(taken, now[I], c[I])), ...);
    pending_rad = select(taken, L(Real(0)), pending_rad);
  }

  // ---- filter -----------------------------------------------------------------------------------

  template <std::size_t... I>
  STRAINWAVE_INLINE static L product(const L* a, const L* b, L start, std::index_sequence<I...>) {
    L sum = start;
    ((sum = fused(a[I], b[I], sum)), ...);
    return sum;
  }
  /// Row I of P C'.
  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE L projected(const L* row, std::index_sequence<J...>) const {
    L sum = p[at<I, 0>] * row[0];
    ((sum = fused(p[at<I, J + 1>], row[J + 1], sum)), ...);
    return sum;
  }
  template <std::size_t... I>
  STRAINWAVE_INLINE void project(const L* row, L* pc, std::index_sequence<I...>) const {
    ((pc[I] = projected<I>(row, std::make_index_sequence<states - 1>{})), ...);
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
  template <std::size_t... A>
  STRAINWAVE_INLINE void update(const Memory& memory, std::size_t lane, const L* pc, L per_variance,
                                L innovation_Nm, L samples, std::index_sequence<A...>) {
    ((noise_of<A>(memory, lane, pc, per_variance, innovation_Nm, samples)), ...);
  }
  template <std::size_t A>
  STRAINWAVE_INLINE void noise_of(const Memory& memory, std::size_t lane, const L* pc,
                                  L per_variance, L innovation_Nm, L samples) {
    const L noise_Nm2 = samples * L::load(memory.process_noise_variance_Nm2[A] + lane);
    update_state<2 * A>(pc, per_variance, innovation_Nm, noise_Nm2);
    update_state<2 * A + 1>(pc, per_variance, innovation_Nm, noise_Nm2);
  }

  // ---- what is rare -----------------------------------------------------------------------------

  template <std::size_t I, std::size_t... J>
  STRAINWAVE_INLINE void reset_row(const Memory& memory, std::size_t lane, Mask reset,
                                   std::index_sequence<J...>) {
    ((p[at<I, J>] = select(
          reset, I == J ? L::load(memory.initial_variance_Nm2[I / 2] + lane) : L(Real(0)),
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
  STRAINWAVE_INLINE L larger_variance() const {
    return larger(p[at<2 * A, 2 * A>], p[at<2 * A + 1, 2 * A + 1>]);
  }
  template <std::size_t... A>
  STRAINWAVE_INLINE Mask beyond_limit(const Memory& memory, std::size_t lane,
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

/// Adds a flag where the mask says so.  All flags of the filter lie within 23 bits, so that their
/// sum is exact in float.
template <class Real>
STRAINWAVE_INLINE void raise(LaneMask<Real> raised, std::size_t flag, Real (*counts)[block_width<Real>],
                             std::size_t lane, Lanes<Real>& status) {
  using L = Lanes<Real>;
  const L one = select(raised, L(Real(1)), L(Real(0)));
  (L::load(counts[flag] + lane) + one).store(counts[flag] + lane);
  if (flag < 7) {
    status = status + one * L(static_cast<Real>(mask(counted_flags[flag])));
  }
}

/// Counts what has to be said about a sample, and returns it as a status in a number.
template <class Real, class Memory>
STRAINWAVE_INLINE Lanes<Real> say(const OscillatorEvents<Real>& events, Memory& memory,
                                  std::size_t lane) {
  Lanes<Real> status = Real(0);
  const auto used = events.torque_usable & events.expected_usable;
  raise(!events.torque_usable, 0, memory.counts, lane, status);
  raise(!events.speed_usable, 1, memory.counts, lane, status);
  raise(!events.expected_usable, 2, memory.counts, lane, status);
  raise(events.limited, 3, memory.counts, lane, status);
  raise(events.reset, 4, memory.counts, lane, status);
  raise(used & !events.moving, 5, memory.counts, lane, status);
  raise(events.above_nyquist, 6, memory.counts, lane, status);
  raise(!(used & events.speed_usable), 7, memory.counts, lane, status);
  memory.any_count = true;
  return status;
}

/// A tile through one group of lanes, from `lane` on.
template <class Real, std::size_t Orders, bool SecondIsDouble>
inline void filter_group(OscillatorLanes<Real, Orders>& memory, const OscillatorTile<Real>& tile,
                         std::size_t lane) {
  using Group = OscillatorGroup<Real, Orders, SecondIsDouble>;
  using L = Lanes<Real>;
  using Mask = LaneMask<Real>;
  constexpr auto by_state = std::make_index_sequence<Group::states>{};
  constexpr auto by_order = std::make_index_sequence<Orders>{};
  const L largest_torque_Nm = Real(largest_usable_torque_Nm);
  const L noise_Nm2 = L::load(memory.measurement_noise_variance_Nm2 + lane);
  Group group;
  group.load(memory, lane);
  for (std::size_t k = 0; k < tile.sample_count; ++k) {
    const L torque_Nm = L::load(tile.measured_torque_Nm + k * block_width<Real> + lane);
    const L speed_rad_s = L::load(tile.motor_speed_rad_s + k * block_width<Real> + lane);
    const L expected_Nm = L::load(tile.expected_torque_Nm + k * tile.expected_stride + lane);
    OscillatorEvents<Real> events;

    L now[Group::states];
    group.output_now(memory, lane, now);
    const L ripple_Nm = Group::product(now, group.x, Real(0), by_state);
    events.torque_usable = absolute(torque_Nm) <= largest_torque_Nm;
    events.expected_usable = absolute(expected_Nm) <= largest_torque_Nm;
    events.moving = (absolute(group.pending_rad) >= group.needed_travel_rad) &
                    (absolute(group.smoothed_speed_rad_s) >=
                     L::load(memory.minimum_speed_rad_s + lane));
    const Mask learned = events.torque_usable & events.expected_usable & events.moving;
    const bool all_learned = learned.all();
    L clean_Nm = torque_Nm - ripple_Nm;
    L innovation_Nm = clean_Nm - expected_Nm;
    L samples = group.samples_without_update + L(Real(1));
    if (all_learned) [[likely]] {
      for (std::size_t i = 0; i < Group::states; ++i) {
        group.c[i] = now[i];
      }
      group.pending_rad = Real(0);
      group.samples_without_update = Real(0);
      group.needed_travel_rad = L::load(memory.minimum_travel_rad + lane);
    } else {
      clean_Nm = select(events.torque_usable, clean_Nm, group.last_torque_Nm);
      innovation_Nm = select(learned, innovation_Nm, L(Real(0)));
      const Mask is_long =
          absolute(group.pending_rad) > L(static_cast<Real>(detail::longest_pending_rotation_rad));
      group.take_output(learned | is_long, now, by_state);
      const L waiting = select(events.torque_usable & events.expected_usable,
                               group.samples_without_update, samples);
      constexpr auto most = static_cast<Real>(detail::most_samples_without_update);
      group.samples_without_update =
          select(learned, L(Real(0)), select(waiting > L(most), L(most), waiting));
      group.needed_travel_rad =
          select(learned, L::load(memory.minimum_travel_rad + lane),
                 select(is_long, L(Real(0)), group.needed_travel_rad));
    }
    group.last_torque_Nm = clean_Nm;

    L pc[Group::states];
    group.project(now, pc, by_state);
    const L variance_Nm2 = Group::product(pc, now, noise_Nm2, by_state);
    const Mask healthy = (variance_Nm2 >= noise_Nm2) &
                         (variance_Nm2 <= L(std::numeric_limits<Real>::max()));
    L per_variance = L(Real(1)) / variance_Nm2;
    events.reset = learned & !healthy;
    if (!(all_learned && healthy.all())) [[unlikely]] {
      const Mask updated = learned & healthy;
      Group::keep(updated, pc, by_state);
      per_variance = select(updated, per_variance, L(Real(0)));
      samples = select(updated, samples, L(Real(0)));
      if (events.reset.any()) {
        group.reset_covariance(memory, lane, events.reset, by_state);
      }
    }
    group.update(memory, lane, pc, per_variance, innovation_Nm, samples, by_order);
    events.limited = Mask{};
    if (memory.any_variance_limit) {
      events.limited = group.beyond_limit(memory, lane, by_order) & learned & healthy;
      if (events.limited.any()) [[unlikely]] {
        group.limit_variance(memory, lane, events.limited, by_order);
      }
    }

    const L highest_order = L::load(memory.highest_order + lane);
    const L period_s = L::load(memory.sample_period_s + lane);
    const L turned_rad = absolute(highest_order * (speed_rad_s * period_s));
    events.speed_usable = turned_rad <= L(static_cast<Real>(largest_rotation_rad));
    events.above_nyquist = events.speed_usable & (turned_rad > L(pi<Real>));
    group.last_speed_rad_s = select(events.speed_usable, speed_rad_s, group.last_speed_rad_s);
    group.pending_rad = group.pending_rad + group.last_speed_rad_s * period_s;
    group.smoothed_speed_rad_s =
        group.smoothed_speed_rad_s + L::load(memory.speed_share + lane) *
                                         (group.last_speed_rad_s - group.smoothed_speed_rad_s);

    clean_Nm.store(tile.torque_Nm + k * block_width<Real> + lane);
    ripple_Nm.store(tile.ripple_Nm + k * tile.ripple_stride + lane);
    L status = Real(0);
    if (!(all_learned && healthy.all() && (turned_rad <= L(pi<Real>)).all() &&
          !events.limited.any())) [[unlikely]] {
      status = say<Real>(events, memory, lane);
    }
    if (tile.status != nullptr) {
      status.store(tile.status + k * block_width<Real> + lane);
    }
  }
  group.store(memory, lane);
}

/// A tile through all lanes of a block.
template <class Real, std::size_t Orders, bool SecondIsDouble>
inline void filter_tile(OscillatorLanes<Real, Orders>& memory, const OscillatorTile<Real>& tile) {
  for (std::size_t lane = 0; lane < block_width<Real>; lane += Lanes<Real>::count) {
    filter_group<Real, Orders, SecondIsDouble>(memory, tile, lane);
  }
}

#undef STRAINWAVE_INLINE
