// SPDX-License-Identifier: Apache-2.0
#include "bind_status.hpp"

namespace strainwave::bindings {

void bind_status(nb::module_& m) {
  nb::enum_<StatusFlag>(m, "StatusFlag", nb::is_flag(), nb::is_arithmetic(),
                        "What a step says about its sample; numbers are stable, logs keep them.")
      .value("torque_not_finite", StatusFlag::torque_not_finite,
             "fault: torque is NaN, infinite or beyond 1e15 Nm")
      .value("rotation_invalid", StatusFlag::rotation_invalid,
             "fault: speed or angle NaN, infinite or beyond reach")
      .value("expected_torque_not_finite", StatusFlag::expected_torque_not_finite,
             "fault: expected torque is NaN or infinite")
      .value("gauge_saturated", StatusFlag::gauge_saturated,
             "fault: a converter code at an end of its range")
      .value("temperature_not_finite", StatusFlag::temperature_not_finite,
             "fault: temperature is NaN or infinite")
      .value("sample_repeated", StatusFlag::sample_repeated, "fault: the sample was seen before")
      .value("sample_out_of_order", StatusFlag::sample_out_of_order,
             "fault: the sample is older than the last one")
      .value("time_not_finite", StatusFlag::time_not_finite,
             "fault: time stamp or interval unusable")
      .value("gauges_insufficient", StatusFlag::gauges_insufficient,
             "fault: no gains do without what is wrong, torque held")
      .value("variance_limited", StatusFlag::variance_limited,
             "limit: covariance cut back to its limit")
      .value("covariance_reset", StatusFlag::covariance_reset,
             "limit: covariance unusable, set back to its start")
      .value("at_rest", StatusFlag::at_rest, "warning: too little travel, adaptation waits")
      .value("samples_missing", StatusFlag::samples_missing,
             "warning: samples are missing before this one")
      .value("order_above_nyquist", StatusFlag::order_above_nyquist,
             "warning: an order turns over half a cycle a sample")
      .value("temperature_out_of_range", StatusFlag::temperature_out_of_range,
             "warning: outside the calibrated temperatures")
      .value("gauge_lost", StatusFlag::gauge_lost,
             "warning: a gauge is lost, for good until cleared")
      .value("gauge_suspected", StatusFlag::gauge_suspected,
             "warning: a gauge is wrong in this sample")
      .value("gauges_disagree", StatusFlag::gauges_disagree,
             "warning: not one gauge alone, or the angle, is wrong");
  m.attr("FAULT_MASK") = fault_mask;
  m.attr("LIMIT_MASK") = limit_mask;
  m.attr("WARNING_MASK") = warning_mask;
}

CountsByName counts_by_name(const EventCounters& counters) {
  CountsByName counts;
  counts["samples"] = counters.samples;
  counts["faults"] = counters.faults;
  const nb::object flags = nb::borrow(nb::type<StatusFlag>());
  for (const nb::handle flag : flags) {
    const auto bits = nb::cast<std::uint32_t>(nb::int_(flag));
    std::size_t bit = 0;
    while ((bits >> bit) != 1U) {
      ++bit;
    }
    counts[flag.attr("name")] = counters.by_bit[bit];
  }
  return counts;
}

}  // namespace strainwave::bindings
