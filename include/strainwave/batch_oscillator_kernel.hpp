// SPDX-License-Identifier: Apache-2.0
/// @file batch_oscillator_kernel.hpp
/// step() of the published filter on lanes, a tile at a time.
///
/// Included by batch_oscillator.hpp within the namespace of each vector level.  Usual samples, from
/// which every lane learns and about which nothing is to be said, have a loop of their own; the
/// others are told apart by masks.
// No guard and no includes: see lanes_each_level.hpp.

// Without the sanitizers: they would take minutes to compile.  What a kernel reads and writes is
// the tile and the block, and nothing in it depends on values.
#define STRAINWAVE_INLINE \
  [[gnu::always_inline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline
#define STRAINWAVE_KERNEL \
  [[gnu::noinline, gnu::no_sanitize("address"), gnu::no_sanitize("undefined")]] inline

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

/// Adds a flag where the mask says so.  All flags of the filter lie within 23 bits, so that their
/// sum is exact in float.
template <class Real>
STRAINWAVE_INLINE void raise(LaneMask<Real> raised, std::size_t flag,
                             Real (*counts)[block_width<Real>], std::size_t lane,
                             Lanes<Real>& status) {
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
  const auto used = events.torque_usable & events.expected_usable & events.speed_usable;
  raise(!events.torque_usable, 0, memory.counts, lane, status);
  raise(!events.speed_usable, 1, memory.counts, lane, status);
  raise(!events.expected_usable, 2, memory.counts, lane, status);
  raise(events.limited, 3, memory.counts, lane, status);
  raise(events.reset, 4, memory.counts, lane, status);
  raise(used & !events.moving, 5, memory.counts, lane, status);
  raise(events.above_nyquist, 6, memory.counts, lane, status);
  raise(!used, 7, memory.counts, lane, status);
  memory.any_count = true;
  return status;
}

/// An unusual sample takes so many after it along, because going over has its price and unusual
/// samples come in groups; and the output row's length is corrected as often.
inline constexpr std::size_t samples_in_a_row = 16;

/// Whether C P C' + R is at least R, and a number: rounding has not cost P its sign.
template <class Real>
STRAINWAVE_INLINE LaneMask<Real> is_healthy(Lanes<Real> variance_Nm2, Lanes<Real> noise_Nm2) {
  return (variance_Nm2 >= noise_Nm2) &
         (variance_Nm2 <= Lanes<Real>(std::numeric_limits<Real>::max()));
}

/// What a sample's place in a tile holds, and where its results go.
template <class Real>
struct OscillatorPlace {
  using L = Lanes<Real>;
  OscillatorTile<Real> tile;
  std::size_t lane;

  [[nodiscard]] STRAINWAVE_INLINE L torque_Nm(std::size_t k) const {
    return L::load(tile.measured_torque_Nm + k * block_width<Real> + lane);
  }
  [[nodiscard]] STRAINWAVE_INLINE L speed_rad_s(std::size_t k) const {
    return L::load(tile.motor_speed_rad_s + k * block_width<Real> + lane);
  }
  [[nodiscard]] STRAINWAVE_INLINE L expected_Nm(std::size_t k) const {
    return L::load(tile.expected_torque_Nm + k * tile.expected_stride + lane);
  }
  /// What put() has put there.
  [[nodiscard]] STRAINWAVE_INLINE L clean_Nm(std::size_t k) const {
    const std::size_t at = k * block_width<Real> + lane;
    return tile.torque_Nm != nullptr ? L::load(tile.torque_Nm + at)
                                     : torque_Nm(k) - L::load(tile.ripple_Nm + at);
  }
  STRAINWAVE_INLINE void put(std::size_t k, L clean_Nm, L ripple_Nm, L status) const {
    if (tile.torque_Nm != nullptr) {
      clean_Nm.store(tile.torque_Nm + k * block_width<Real> + lane);
    }
    if (tile.ripple_Nm != nullptr) {
      ripple_Nm.store(tile.ripple_Nm + k * block_width<Real> + lane);
    }
    put_status(k, status);
  }
  STRAINWAVE_INLINE void put_status(std::size_t k, L status) const {
    if (tile.status != nullptr) {
      status.store(tile.status + k * block_width<Real> + lane);
    }
  }
};

/// Which orders turn so slowly, where usual_order is within its limit, that short series do.
template <class Real, std::size_t Orders>
STRAINWAVE_INLINE void find_slow_orders(const OscillatorLanes<Real, Orders>& memory,
                                        std::size_t lane, bool* slow) {
  using L = Lanes<Real>;
  const L share = L::load(memory.usual_order + lane) *
                  L(detail::largest_small_rad<Real> / detail::largest_reduced_rad<Real>);
  for (std::size_t a = 1; a < Orders; ++a) {
    slow[a] = (L::load(memory.order[a] + lane) <= share).all();
  }
}

/// Holds an order's variances to their limit, where there is one, and says so.
template <class Real, std::size_t Orders, class Group>
STRAINWAVE_INLINE void limit_usual(OscillatorLanes<Real, Orders>& memory, std::size_t lane,
                                   Group& group, const OscillatorPlace<Real>& place,
                                   std::size_t k) {
  constexpr auto by_order = std::make_index_sequence<Orders>{};
  const auto beyond = group.beyond_limit(memory, lane, by_order);
  if (beyond.any()) [[unlikely]] {
    group.limit_variance(memory, lane, beyond, by_order);
    Lanes<Real> status = Real(0);
    raise(beyond, 3, memory.counts, lane, status);
    memory.any_count = true;
    place.put_status(k, status);
  }
}

/// One usual sample; false, and nothing has changed, where it is not one.  The output row is that
/// of this sample, and then that of the next one.
template <class Real, std::size_t Orders, class Group>
STRAINWAVE_INLINE bool learn_usual(OscillatorLanes<Real, Orders>& memory, std::size_t lane,
                                   Group& group, const OscillatorPlace<Real>& place,
                                   const bool* slow, std::size_t k) {
  using L = Lanes<Real>;
  constexpr auto by_order = std::make_index_sequence<Orders>{};
  const L torque_Nm = place.torque_Nm(k);
  const L expected_Nm = place.expected_Nm(k);
  const L speed_rad_s = place.speed_rad_s(k);
  const L rotation_rad = speed_rad_s * L::load(memory.sample_period_s + lane);
  // Both torques in one comparison, which is the stricter one.
  auto usable = (absolute(torque_Nm) + absolute(expected_Nm) <= L(Real(largest_usable_torque_Nm))) &
                group.is_usual_rotation(memory, lane, rotation_rad);
  if (memory.any_rest) {
    usable = usable & group.is_moving(memory, lane);
  }
  if (!usable.all()) [[unlikely]] {
    return false;
  }
  const L noise_Nm2 = L::load(memory.measurement_noise_variance_Nm2 + lane);
  L pc[Group::states];
  group.project(group.c, pc, std::make_index_sequence<Group::states>{});
  const L variance_Nm2 = Group::product(pc, group.c, noise_Nm2, by_order);
  if (!is_healthy(variance_Nm2, noise_Nm2).all()) [[unlikely]] {
    return false;
  }
  const L ripple_Nm = Group::product(group.c, group.x, Real(0), by_order);
  const L clean_Nm = torque_Nm - ripple_Nm;
  const L per_variance = L(Real(1)) / variance_Nm2;
  // The next row is made while the quotient is waited for.
  group.template turn_orders<true>(memory, lane, rotation_rad, slow, group.c, by_order);
  group.template update<true>(memory, lane, pc, per_variance, clean_Nm - expected_Nm, L(Real(1)),
                              by_order);
  if (memory.any_rest) {
    group.travel_rad = rotation_rad;
    group.last_speed_rad_s = speed_rad_s;
    group.smooth_speed(memory, lane);
  }
  place.put(k, clean_Nm, ripple_Nm, Real(0));
  if (memory.any_variance_limit) {
    limit_usual(memory, lane, group, place, k);
  }
  return true;
}

/// Usual samples from `start` on: every lane learns, and nothing is to be said.  Returns the first
/// sample that is not so, which has changed nothing.
template <class Real, std::size_t Orders, bool SecondIsDouble>
STRAINWAVE_KERNEL std::size_t filter_usual(OscillatorLanes<Real, Orders>& memory,
                                           const OscillatorTile<Real>& tile, std::size_t lane,
                                           std::size_t start) {
  using L = Lanes<Real>;
  constexpr auto by_order = std::make_index_sequence<Orders>{};
  const OscillatorPlace<Real> place{tile, lane};
  OscillatorGroup<Real, Orders, SecondIsDouble> group;  // NOLINT(*-member-init): load() fills it
  group.load(memory, lane);
  if (!group.is_usual_rotation(memory, lane, group.pending_rad).all()) {
    return start;
  }
  bool slow[Orders] = {};
  find_slow_orders(memory, lane, slow);
  group.template turn_orders<true>(memory, lane, group.pending_rad, slow, group.c, by_order);
  group.pending_rad = Real(0);
  const Ahead<Real>* const ahead = lane == 0 ? tile.ahead : nullptr;
  std::size_t k = start;
  bool is_usual = true;
  while (is_usual && k < tile.sample_count) {
    const std::size_t row_end = (k / samples_in_a_row + 1) * samples_in_a_row;
    const std::size_t end = row_end < tile.sample_count ? row_end : tile.sample_count;
    for (; k < end; ++k) {
      if (ahead != nullptr) {
        ahead[0].ask(tile.ahead_at, k);
        ahead[1].ask(tile.ahead_at, k);
        ahead[2].ask(tile.ahead_at, k);
      }
      is_usual = learn_usual(memory, lane, group, place, slow, k);
      if (!is_usual) [[unlikely]] {
        break;
      }
    }
    group.correct_length(by_order);
  }
  if (k > start) {
    group.last_torque_Nm = place.clean_Nm(k - 1);
    group.last_speed_rad_s = place.speed_rad_s(k - 1);
    group.travel_rad = group.last_speed_rad_s * L::load(memory.sample_period_s + lane);
  }
  if (!memory.any_rest) {
    group.smoothed_speed_rad_s = group.last_speed_rad_s;
  }
  group.store(memory, lane);
  return k;
}

/// Samples that some lane does not learn from, or about which something is to be said.
template <class Real, std::size_t Orders, bool SecondIsDouble>
STRAINWAVE_KERNEL void filter_any(OscillatorLanes<Real, Orders>& memory,
                                  const OscillatorTile<Real>& tile, std::size_t lane,
                                  std::size_t start, std::size_t end) {
  using Group = OscillatorGroup<Real, Orders, SecondIsDouble>;
  using L = Lanes<Real>;
  constexpr auto by_order = std::make_index_sequence<Orders>{};
  constexpr auto by_state = std::make_index_sequence<Group::states>{};
  const OscillatorPlace<Real> place{tile, lane};
  const L largest_torque_Nm = Real(largest_usable_torque_Nm);
  const L noise_Nm2 = L::load(memory.measurement_noise_variance_Nm2 + lane);
  const L period_s = L::load(memory.sample_period_s + lane);
  Group group;
  group.load(memory, lane);
  for (std::size_t k = start; k < end; ++k) {
    OscillatorEvents<Real> events = {};
    const L torque_Nm = place.torque_Nm(k);
    const L expected_Nm = place.expected_Nm(k);
    L now[Group::states];
    group.template turn_orders<false>(memory, lane, group.pending_rad, nullptr, now, by_order);
    const L ripple_Nm = Group::product(now, group.x, Real(0), by_order);
    events.torque_usable = absolute(torque_Nm) <= largest_torque_Nm;
    events.expected_usable = absolute(expected_Nm) <= largest_torque_Nm;
    events.moving = group.is_moving(memory, lane);
    const L speed_rad_s = place.speed_rad_s(k);
    const L cycles = absolute(L::load(memory.highest_order + lane) *
                              (speed_rad_s * L::load(memory.turns_period_s + lane)));
    events.speed_usable = cycles <= L(detail::largest_rotation_turns<Real>);
    events.above_nyquist = events.speed_usable & (cycles > L(Real(0.5)));
    const auto used = events.torque_usable & events.expected_usable & events.speed_usable;
    const auto learned = used & events.moving;
    group.last_torque_Nm =
        select(events.torque_usable, torque_Nm - ripple_Nm, group.last_torque_Nm);

    L pc[Group::states];
    group.project(now, pc, by_state);
    const L variance_Nm2 = Group::product(pc, now, noise_Nm2, by_order);
    const auto updated = learned & is_healthy(variance_Nm2, noise_Nm2);
    events.reset = learned & !updated;
    group.keep(updated, pc, by_state);
    group.reset_covariance(memory, lane, events.reset, by_state);
    group.template update<false>(memory, lane, pc,
                                 select(updated, L(Real(1)) / variance_Nm2, L(Real(0))),
                                 select(learned, torque_Nm - expected_Nm - ripple_Nm, L(Real(0))),
                                 select(updated | !used, L(Real(1)), L(Real(0))), by_order);
    events.limited = group.beyond_limit(memory, lane, by_order) & updated;
    group.limit_variance(memory, lane, events.limited, by_order);
    group.take_all(now, by_state);
    group.last_speed_rad_s = select(events.speed_usable, speed_rad_s, group.last_speed_rad_s);
    group.pending_rad = group.last_speed_rad_s * period_s;
    group.travel_rad = select(learned, L(Real(0)), group.travel_rad) + group.pending_rad;
    group.smooth_speed(memory, lane);
    place.put(k, group.last_torque_Nm, ripple_Nm, say<Real>(events, memory, lane));
  }
  group.correct_length(by_order);
  group.store(memory, lane);
}

/// A tile through one group of lanes, from `lane` on.
template <class Real, std::size_t Orders, bool SecondIsDouble>
inline void filter_group(OscillatorLanes<Real, Orders>& memory, const OscillatorTile<Real>& tile,
                         std::size_t lane) {
  for (std::size_t k = 0; k < tile.sample_count;) {
    k = filter_usual<Real, Orders, SecondIsDouble>(memory, tile, lane, k);
    const std::size_t left = tile.sample_count - k;
    const std::size_t end = k + (left < samples_in_a_row ? left : samples_in_a_row);
    if (k < end) {
      filter_any<Real, Orders, SecondIsDouble>(memory, tile, lane, k, end);
    }
    k = end;
  }
}

/// A tile through all lanes of a block.
template <class Real, std::size_t Orders, bool SecondIsDouble>
inline void filter_tile(OscillatorLanes<Real, Orders>& memory, const OscillatorTile<Real>& tile) {
  for (std::size_t lane = 0; lane < block_width<Real>; lane += Lanes<Real>::count) {
    filter_group<Real, Orders, SecondIsDouble>(memory, tile, lane);
  }
}

#undef STRAINWAVE_KERNEL
#undef STRAINWAVE_INLINE
