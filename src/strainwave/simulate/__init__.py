"""Simulated test stations: a strain wave gear with motor, load, gauges and data acquisition.

Built from physics and not from any filter's equations, so that filters can be judged with it.  Every
run carries the truth beside its signals.  Presets stand for the experiments of two papers.
"""

from strainwave.simulate.acquisition import Acquisition, Encoder, Tachometer
from strainwave.simulate.commands import CurrentCommand, SpeedCommand
from strainwave.simulate.driving import (
    STANDSTILL,
    constant_speed,
    loading_sequence,
    reversals,
    step,
    up_and_down,
)
from strainwave.simulate.faults import Fault, FaultKind
from strainwave.simulate.integration import integrated_motion
from strainwave.simulate.loading import LoadingExperiment, load_by_weights
from strainwave.simulate.mechanics import Flexspline, Friction, Load, Motor
from strainwave.simulate.misalignment import Misalignment, MisalignmentTerm
from strainwave.simulate.motion import Drive, Motion, prescribed_motion
from strainwave.simulate.presets.godler2000 import godler2000
from strainwave.simulate.presets.taghirad1999 import taghirad1999
from strainwave.simulate.results import Run, Truth
from strainwave.simulate.ripple import MeshRipple, RippleOrder
from strainwave.simulate.station import Bridge, Station
from strainwave.simulate.strain_field import GaugePlacement, StrainField, WaveHarmonic
from strainwave.simulate.temperature import Temperature
from strainwave.simulate.trajectories import NOTHING, Chirp, PiecewiseLinear, Profile, Sine, Sum

__all__ = [
    "NOTHING",
    "STANDSTILL",
    "Acquisition",
    "Bridge",
    "Chirp",
    "CurrentCommand",
    "Drive",
    "Encoder",
    "Fault",
    "FaultKind",
    "Flexspline",
    "Friction",
    "GaugePlacement",
    "Load",
    "LoadingExperiment",
    "MeshRipple",
    "Misalignment",
    "MisalignmentTerm",
    "Motion",
    "Motor",
    "PiecewiseLinear",
    "Profile",
    "RippleOrder",
    "Run",
    "Sine",
    "SpeedCommand",
    "Station",
    "StrainField",
    "Sum",
    "Tachometer",
    "Temperature",
    "Truth",
    "WaveHarmonic",
    "constant_speed",
    "godler2000",
    "integrated_motion",
    "load_by_weights",
    "loading_sequence",
    "prescribed_motion",
    "reversals",
    "step",
    "taghirad1999",
    "up_and_down",
]
