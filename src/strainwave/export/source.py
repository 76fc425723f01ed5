"""The text of the exported files, from a joint's values and templates."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Final

import jinja2
import numpy as np

from strainwave.errors import ConfigurationError, InputError
from strainwave.export.configuration import JointValues, values_of
from strainwave.export.names import joint_identifier
from strainwave.export.values import Precision, checksum, text_literal
from strainwave.joint import SCHEMA_VERSION, canonical_hash
from strainwave.sensor import TorqueSensor

if TYPE_CHECKING:
    from strainwave.joint import Joint

#: Names of the files of the C interface, the same for every joint: firmware includes them by name.
C_HEADER: Final = "strainwave_joint.h"
C_SOURCE: Final = "strainwave_joint.cpp"

_TEMPLATES: Final = jinja2.Environment(
    loader=jinja2.PackageLoader("strainwave.export", "templates"),
    autoescape=False,  # noqa: S701 - the pages are C++; names are checked, texts are escaped literals
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


@dataclass(frozen=True)
class ExportedJoint:
    """A joint that is ready to be written.

    Attributes
    ----------
    identifier : str
        Its namespace, and the name of its header.
    joint_name : str
        Its name in the joint file.
    joint_hash : str
        The joint file's canonical hash.
    version : str
        Version of strainwave that the header names.
    precision : {"float", "double"}
        Type of the real numbers.
    values : JointValues
        The configuration.
    """

    identifier: str
    joint_name: str
    joint_hash: str
    version: str
    precision: Precision
    values: JointValues

    @property
    def checksum(self) -> int:
        """The checksum that the header states."""
        return checksum(self.values.parts, self.precision)

    @property
    def real_bytes(self) -> int:
        """Size of a real number."""
        return 4 if self.precision == "float" else 8

    @property
    def state_bytes(self) -> int:
        """Room for the state behind the C interface; see `state_bytes`."""
        values = self.values
        return state_bytes(values.filter, values.gauges, values.capacity, self.real_bytes)

    @property
    def learned_words(self) -> int:
        """Words of a block of learned coefficients; 1 for a filter that keeps none."""
        if self.values.filter != "ripple":
            return 1
        pairs = self.values.capacity
        return 4 + 3 * pairs + (4 * pairs + 1) * self.real_bytes // 4


@dataclass(frozen=True)
class ExportedSource:
    """The text of the three files.

    Attributes
    ----------
    header_name, header : str
        The joint's C++ header.
    c_header, c_source : str
        What the C interface needs: sizes, and the functions.
    """

    header_name: str
    header: str
    c_header: str
    c_source: str

    @property
    def files(self) -> dict[str, str]:
        """Texts by file name; the header, by which the others are found, comes last."""
        return {C_HEADER: self.c_header, C_SOURCE: self.c_source, self.header_name: self.header}


def state_bytes(filter_name: str, gauges: int, capacity: int, real_bytes: int) -> int:
    """Compute room for the state of a sensor on processors of 32 and of 64 bits.

    Fixed parts, those of each gauge, and the filter's covariance, which grows with the square of
    its capacity. The C++ compiler checks that it suffices.

    Parameters
    ----------
    filter_name : str
        ``ripple`` or ``oscillator``.
    gauges, capacity : int
        Channels; pairs of coefficients, or orders of the oscillator filter.
    real_bytes : int
        4 or 8.

    Returns
    -------
    int
        Bytes, a multiple of 8.
    """
    # Where the processor has vectors, columns are filled up to 2, 4 or a multiple of 8.
    step = {1: 2, 2: 4}.get(capacity, 8)
    column = -(-2 * capacity // step) * step
    reals = (2 * capacity + 1) * column
    if filter_name == "ripple":
        reals, fixed, code = reals + 5 * capacity, 400 + 52 * real_bytes, 0
    else:  # the chain keeps the last sample's codes besides
        reals, fixed, code = reals + capacity, 412 + 13 * real_bytes, 4
    total = real_bytes * reals + (8 + code + 3 * real_bytes) * gauges + fixed
    return -(-total // 8) * 8


def exported(
    joint: Joint,
    *,
    name: str | None = None,
    precision: Precision = "float",
    software_version: str | None = None,
) -> ExportedJoint:
    """Make a joint ready to be written.

    Parameters
    ----------
    joint : Joint
        A joint with what the whole chain needs; see `strainwave.configuration.sensor_of`.
    name : str, optional
        Name of the namespace; the joint's own without.
    precision : {"float", "double"}
        Type of the real numbers.
    software_version : str, optional
        Version that the header names; that of this package without.

    Returns
    -------
    ExportedJoint
        Values, names and hash.

    Raises
    ------
    InputError
        If a section is missing, the core cannot use a value in this precision, or the name is no
        identifier.
    """
    identifier = joint_identifier(joint, name)
    values = values_of(joint)
    dtype = np.float32 if precision == "float" else np.float64
    try:
        TorqueSensor(values.config, values.kept, dtype=dtype)
    except ConfigurationError as error:
        raise InputError(
            f'joint "{joint.identity.name}": {error}, in the precision {precision}'
        ) from error
    return ExportedJoint(
        identifier=identifier,
        joint_name=joint.identity.name,
        joint_hash=canonical_hash(joint),
        version=software_version or version("strainwave"),
        precision=precision,
        values=values,
    )


def rendered(joint: ExportedJoint) -> ExportedSource:
    """Write the text of a joint's files.

    Parameters
    ----------
    joint : ExportedJoint
        The joint.

    Returns
    -------
    ExportedSource
        The texts.
    """
    values, precision = joint.values, joint.precision
    context = {
        "joint": joint,
        "values": values,
        "schema_version": SCHEMA_VERSION,
        "name_literal": text_literal(joint.joint_name),
        "guard": joint.identifier.upper(),
        "checksum": f"0x{joint.checksum:08X}U",
        "gear": values.gear.text(precision),
        "sensor": values.sensor.text(precision),
        "learned": None if values.learned is None else values.learned.text(precision),
    }
    texts = [
        _TEMPLATES.get_template(name).render(context)
        for name in ("joint.hpp.j2", "strainwave_joint.h.j2", "strainwave_joint.cpp.j2")
    ]
    return ExportedSource(f"{joint.identifier}.hpp", *texts)
