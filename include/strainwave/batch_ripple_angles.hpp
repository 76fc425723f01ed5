// SPDX-License-Identifier: Apache-2.0
/// @file batch_ripple_angles.hpp
/// Motor angles of a block's channels as the lanes take them: turns, fractions and cycles.
#pragma once

#include <cstddef>

#include "strainwave/batch_layout.hpp"
#include "strainwave/batch_ripple_lanes.hpp"

namespace strainwave::detail {

/// A level's conversion of one channel's angles.
template <class Real>
using ConvertAngles = void (*)(const double* angle_rad, std::size_t count, Real* turns,
                               Real* fraction, const OrderCycles<Real>* orders,
                               std::size_t order_count);

/// Angles of a block, converted channel by channel and then put side by side.
template <class Real, std::size_t Pairs>
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): filled tile by tile
class RippleAngles {
 public:
  static constexpr std::size_t width = block_width<Real>;

  /// Orders with a denominator in any lane: their cycles depend on whole turns as well.
  template <class Block>
  void put_orders(const Block& block, std::size_t order_count) {
    for (std::size_t a = 0; a < order_count; ++a) {
      bool any = false;
      for (const auto* config : block.configs) {
        any = any || (config != nullptr && config->orders[a].order.denominator != 1);
      }
      if (any) {
        put_order(block, a);
      }
    }
  }

  /// Samples from `at` on, lane by lane those of the channel `from[lane]`.
  template <class Block>
  void gather_into(RippleTile<Real>& tile, ConvertAngles<Real> convert, const Block& block,
                   const std::size_t* from, std::size_t at, std::size_t count) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      if (from[lane] == lane) {
        convert(block.channels[lane].motor_angle_rad + at, count, turns_of_[lane],
                fractions_of_[lane], orders_of_[lane], order_count_);
      }
    }
    gather_rows(turns_of_, from, count, turns_);
    gather_rows(fractions_of_, from, count, fractions_);
    tile.turns = turns_.values;
    tile.fraction = fractions_.values;
    for (std::size_t i = 0; i < order_count_; ++i) {
      gather_rows(cycles_of_[i], from, count, cycles_[i]);
      tile.order_fraction[order_[i]] = cycles_[i].values;
    }
  }

 private:
  using Rows = Real[width][tile_samples];

  template <class Block>
  void put_order(const Block& block, std::size_t a) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      OrderCycles<Real>& cycles = orders_of_[lane][order_count_];
      cycles.fraction = cycles_of_[order_count_][lane];
      if (block.configs[lane] != nullptr) {
        const Order order = block.configs[lane]->orders[a].order;
        cycles.numerator = static_cast<double>(order.numerator);
        cycles.denominator = static_cast<double>(order.denominator);
        cycles.per_denominator = 1.0 / cycles.denominator;
      }
    }
    order_[order_count_++] = a;
  }

  static void gather_rows(const Rows& of_lanes, const std::size_t* from, std::size_t count,
                          Tile<Real>& tile) {
    const Real* rows[width];
    for (std::size_t lane = 0; lane < width; ++lane) {
      rows[lane] = of_lanes[from[lane]];
    }
    gather(rows, 0, count, tile.values);
  }

  Tile<Real> turns_;
  Tile<Real> fractions_;
  Tile<Real> cycles_[Pairs];
  Rows turns_of_;
  Rows fractions_of_;
  Rows cycles_of_[Pairs];
  OrderCycles<Real> orders_of_[width][Pairs];
  std::size_t order_[Pairs] = {};  ///< of the filters, for each that is converted
  std::size_t order_count_ = 0;
};

}  // namespace strainwave::detail
