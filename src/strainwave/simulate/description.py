"""A test station's description: everything from the motor to the converter."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, Self

import numpy as np

import strainwave._core as core
from strainwave.errors import ConfigurationError
from strainwave.simulate.acquisition import Acquisition, Encoder, Tachometer
from strainwave.simulate.checks import (
    require_choice,
    require_integer,
    require_length,
    require_number,
)
from strainwave.simulate.faults import Fault
from strainwave.simulate.mechanics import Flexspline, Load, Motor
from strainwave.simulate.misalignment import Misalignment
from strainwave.simulate.ripple import MeshRipple
from strainwave.simulate.strain_field import GaugePlacement, StrainField
from strainwave.simulate.temperature import Temperature


@dataclass(frozen=True)
class Bridge:
    """From the gauges to the converter.

    Parameters
    ----------
    wiring : str
        "half_bridge_each": a channel a gauge; "full_bridge": all gauges in one bridge.
    supply_V : float
        Supply of the bridge, V, above 0.
    amplifier : strainwave._core.Amplifier
        Gain, offset and rails.
    converter : strainwave._core.Converter
        Bits and range.
    """

    wiring: Literal["half_bridge_each", "full_bridge"] = "half_bridge_each"
    supply_V: float = 10.0
    amplifier: core.Amplifier = field(default_factory=core.Amplifier)
    converter: core.Converter = field(default_factory=core.Converter)

    def __post_init__(self) -> None:
        require_choice("wiring", self.wiring, ("half_bridge_each", "full_bridge"))
        require_number("supply_V", self.supply_V, "V", above=0.0)

    def volts_per_strain(self, gauge: GaugePlacement, gauge_count: int) -> float:
        """Return what one rosette's epsilon_1 - epsilon_2 adds to the sum of all channels.

        Parameters
        ----------
        gauge : GaugePlacement
            The rosette.
        gauge_count : int
            How many there are.

        Returns
        -------
        float
            V per strain, behind the amplifier.  Taghirad & Belanger 1999, eq. (4): K/4 E_sup in a
            half bridge, K/2 E_sup over the number of gauges in a full one.
        """
        arms = 4.0 if self.wiring == "half_bridge_each" else 2.0 * gauge_count
        return gauge.gauge_factor / arms * self.supply_V * float(self.amplifier.gain)


@dataclass(frozen=True)
class StationDescription:
    """What a simulated test station is made of.  Torques count in the motor's sense of rotation.

    Parameters
    ----------
    gear : strainwave._core.Gear
        Ratio, configuration, rated torque.
    gauges : tuple of GaugePlacement
        The rosettes.
    strain_field : StrainField
        The diaphragm.
    motor : Motor
        Motor with wave generator and friction.
    flexspline : Flexspline
        The gear's spring.
    load : Load
        The load.
    mesh_ripple : MeshRipple
        Real ripple.
    misalignment : Misalignment
        Crosstalk of the load's misalignment.
    bridge : Bridge
        Bridge, amplifier, converter.
    temperature : Temperature
        Temperature and drifts.
    acquisition : Acquisition
        Sampling.
    tachometer : Tachometer
        Motor speed.
    motor_encoder, output_encoder : Encoder
        Angles.
    faults : tuple of Fault
        What fails.
    """

    gear: core.Gear
    gauges: tuple[GaugePlacement, ...]
    strain_field: StrainField
    motor: Motor = field(default_factory=Motor)
    flexspline: Flexspline = field(default_factory=Flexspline)
    load: Load = field(default_factory=Load)
    mesh_ripple: MeshRipple = field(default_factory=MeshRipple)
    misalignment: Misalignment = field(default_factory=Misalignment)
    bridge: Bridge = field(default_factory=Bridge)
    temperature: Temperature = field(default_factory=Temperature)
    acquisition: Acquisition = field(default_factory=Acquisition)
    tachometer: Tachometer = field(default_factory=Tachometer)
    motor_encoder: Encoder = field(default_factory=Encoder)
    output_encoder: Encoder = field(default_factory=Encoder)
    faults: tuple[Fault, ...] = ()

    def __post_init__(self) -> None:
        fewest = 2 if self.bridge.wiring == "full_bridge" else 1
        if len(self.gauges) < fewest:
            raise ConfigurationError(
                "gauges", len(self.gauges), "gauges", f"at least {fewest} for {self.bridge.wiring},"
            )
        for gauge in self.gauges:
            self.strain_field.check_gauge(gauge)
        for fault in self.faults:
            require_integer("gauge", fault.gauge, "", minimum=0, maximum=len(self.gauges) - 1)
        drift = self.temperature.zero_strain_per_K
        if isinstance(drift, tuple):
            require_length("zero_strain_per_K", drift, len(self.gauges), "one a gauge")

    @property
    def channel_count(self) -> int:
        """Number of converter channels."""
        return len(self.gauges) if self.bridge.wiring == "half_bridge_each" else 1

    @property
    def wave_factor(self) -> float:
        """Factor m: turns of the wave over the flexspline per motor turn."""
        return float(self.gear.wave_factor)

    @property
    def sensor_gain_Nm_per_V(self) -> float:
        """Torque by the sum of all channels' voltages, at small torque and reference temperature."""
        volts_per_Nm = sum(
            self.bridge.volts_per_strain(gauge, len(self.gauges))
            * self.strain_field.shear_per_Nm(gauge.radius_m)
            * np.cos(2 * gauge.orientation_error_rad)
            for gauge in self.gauges
        )
        return float(1.0 / volts_per_Nm)

    def with_changes(self, **changes: Any) -> Self:
        """Return the station with some of its fields changed.

        Parameters
        ----------
        **changes : object
            New values of fields.

        Returns
        -------
        Station
            The changed station.
        """
        known = [each.name for each in fields(self)]
        for name in changes:
            if name not in known:
                raise ConfigurationError(
                    "with_changes", name, "", f"a field of a station ({', '.join(known)})"
                )
        return replace(self, **changes)
