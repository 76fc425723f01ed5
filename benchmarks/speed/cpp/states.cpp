// SPDX-License-Identifier: Apache-2.0
// What a sample costs by the number of states: capacities from 4 to 31, all of them in use.
#include <string>
#include <utility>

#include "cases.hpp"
#include "filters.hpp"

namespace speed {

namespace {

/// Orders 2, 4, 6, ...
template <std::size_t Orders>
constexpr strainwave::OscillatorFilterConfig<float, Orders> published_with() {
  auto config = strainwave::taghirad1999_4<float, Orders>();
  config.order_count = Orders;
  for (std::size_t a = 0; a < Orders; ++a) {
    config.orders[a] = {static_cast<std::uint32_t>(2 * a + 2), 1};
    config.process_noise_variance_Nm2[a] = 1e3F;
  }
  return config;
}
template <std::size_t Pairs>
constexpr strainwave::RippleFilterConfig<float, Pairs> default_with() {
  strainwave::RippleFilterConfig<float, Pairs> config;
  config.order_count = Pairs;
  for (std::size_t a = 0; a < Pairs; ++a) {
    config.orders[a].order = {static_cast<std::uint32_t>(2 * a + 2), 1};
  }
  return config;
}

template <std::size_t Orders>
void add_published_of(Cases& cases) {
  cases["states_published_" + std::to_string(2 * Orders)] = [](const Recording& recording,
                                                               const Options& /*options*/) {
    return published_case<float>(recording, [config = published_with<Orders>()] { return config; });
  };
}
template <std::size_t Pairs>
void add_default_of(Cases& cases) {
  cases["states_default_" + std::to_string(1 + 2 * Pairs)] = [](const Recording& recording,
                                                                const Options& /*options*/) {
    return default_case<float>(recording, [config = default_with<Pairs>()] { return config; });
  };
}

template <std::size_t... Orders, std::size_t... Pairs>
void add_all(Cases& cases, std::index_sequence<Orders...> /*orders*/,
             std::index_sequence<Pairs...> /*pairs*/) {
  (add_published_of<Orders>(cases), ...);
  (add_default_of<Pairs>(cases), ...);
}

}  // namespace

void add_states(Cases& cases) {
  add_all(cases, std::index_sequence<2, 3, 4, 6, 8, 12, 15>{},
          std::index_sequence<2, 3, 5, 7, 9, 11, 15>{});
}

}  // namespace speed
