// SPDX-License-Identifier: Apache-2.0
// The core's filters, one channel, sample by sample.
#include "cases.hpp"
#include "filters.hpp"

namespace speed {

namespace {

/// The configuration is a constant, as on a microcontroller and as the dense peers have it.
template <class Real>
Case published_constant(const Recording& recording, const Options& /*options*/) {
  return published_case<Real>(recording, []() -> const auto& { return published<Real>; });
}
template <class Real>
Case default_constant(const Recording& recording, const Options& /*options*/) {
  return default_case<Real>(recording, []() -> const auto& { return default_15<Real>; });
}

/// The configuration is read, as from a joint file.
template <class Real>
Case published_run_time(const Recording& recording, const Options& /*options*/) {
  return published_case<Real>(recording, [config = published<Real>] { return config; });
}
template <class Real>
Case default_run_time(const Recording& recording, const Options& /*options*/) {
  return default_case<Real>(recording, [config = default_15<Real>] { return config; });
}

}  // namespace

void add_core(Cases& cases) {
  cases["published_float"] = published_constant<float>;
  cases["published_double"] = published_constant<double>;
  cases["published_float_run_time"] = published_run_time<float>;
  cases["default_float"] = default_constant<float>;
  cases["default_double"] = default_constant<double>;
  cases["default_float_run_time"] = default_run_time<float>;
}

}  // namespace speed
