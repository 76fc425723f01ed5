// Configurations that several tests of the published filter use.
#pragma once

#include <cstddef>

#include "strainwave/oscillator_config.hpp"

template <class Real, std::size_t MaxOrders>
strainwave::OscillatorFilterConfig<Real, MaxOrders> tuned(std::size_t count) {
  strainwave::OscillatorFilterConfig<Real, MaxOrders> config;
  const strainwave::Order orders[8] = {{2, 1},   {4, 1}, {1, 100}, {7, 1},
                                       {2, 241}, {1, 1}, {6, 1},   {13, 5}};
  config.order_count = count;
  for (std::size_t a = 0; a < count; ++a) {
    config.orders[a] = orders[a];
    config.process_noise_variance_Nm2[a] = Real(1e-4);
  }
  return config;
}
