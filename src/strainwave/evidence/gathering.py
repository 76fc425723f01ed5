"""Everything that a report shows, gathered while a recording is filtered."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from strainwave.evidence.contacts import Contact, Scene, add_contacts
from strainwave.evidence.lines import OrderLine, order_lines
from strainwave.evidence.motion import rows_in_motion
from strainwave.evidence.spectra import OrderMap, OrderSpectrum, order_map, order_spectrum
from strainwave.evidence.witness import Witness
from strainwave.fidelity.of_joint import ASSUMED_ORDERS
from strainwave.joint.provenance import Provenance
from strainwave.methods.interface import Cleaned, joined
from strainwave.methods.orders import removed_orders
from strainwave.records.filtering import filter_log
from strainwave.records.in_order import InOrder
from strainwave.records.options import Options
from strainwave.records.passes import Progress, untold

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.evidence.envelope import Envelope
    from strainwave.evidence.flags import FlaggedRows
    from strainwave.methods.registry import Setting
    from strainwave.records import FilteredLog
    from strainwave.records.identified_log import IdentifiedLog
    from strainwave.samples import Samples


@dataclass(frozen=True)
class Evidence:
    """What is known of one filtered recording.

    Attributes
    ----------
    rows, rows_looked_at : int
        Rows of the recording, and how many from its start everything but envelope and flags is
        computed from.
    rejected_rows, repeated_rows : int
        Rows of the whole recording that were not used, apart from those that repeat the row before,
        and those.
    motor_turns : float
        Travel of the motor in the rows that were looked at, turns.
    envelope : Envelope
        Torque before and after, of the whole recording.
    spectrum : OrderSpectrum or None
        Amplitude against order; None where the motor does not turn far enough.
    speed_map : OrderMap or None
        Amplitude against speed and order, likewise.
    lines : tuple of OrderLine
        Each order over time and load.
    orders_not_told : tuple of float
        Orders that are removed but cannot be told from slow torque, or from another order, in
        windows of a few motor turns.
    contacts : tuple of Contact
        What came through of torque that was added.
    flags : tuple of FlaggedRows
        Rows that bear a flag.
    provenance : Provenance
        Name and SHA-256 of the recording, time and version.
    """

    rows: int
    rows_looked_at: int
    rejected_rows: int
    repeated_rows: int
    motor_turns: float
    envelope: Envelope
    spectrum: OrderSpectrum | None
    speed_map: OrderMap | None
    lines: tuple[OrderLine, ...]
    orders_not_told: tuple[float, ...]
    contacts: tuple[Contact, ...]
    flags: tuple[FlaggedRows, ...]
    provenance: Provenance

    @property
    def removed(self) -> tuple[OrderLine, ...]:
        """Lines that are not kept, the strongest first."""
        lines = [line for line in self.lines if not line.is_kept]
        return tuple(sorted(lines, key=lambda line: -line.before_rms_Nm))

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            The numbers of the report; its curves are in the report alone.
        """
        return {
            "rows_looked_at": self.rows_looked_at,
            "rows_rejected": self.rejected_rows,
            "rows_repeated": self.repeated_rows,
            "motor_turns": self.motor_turns,
            "orders": [line.as_dict() for line in self.lines],
            "orders_not_told": list(self.orders_not_told),
            "contacts": [contact.as_dict() for contact in self.contacts],
            "input_sha256": self.provenance.input_sha256,
        }


def filter_with_evidence(
    path: Path,
    out: Path | None,
    options: Options,
    *,
    joint_path: Path | None = None,
    method: str | None = None,
    in_sequence: bool = False,
    progress: Progress = untold,
) -> tuple[FilteredLog, Evidence]:
    """Filter a recording and gather what a report shows of it.

    Parameters
    ----------
    path : Path
        The recording.
    out : Path or None
        Where the result goes; None writes none.
    options : Options
        How the recording is read.
    joint_path : Path, optional
        The joint file.
    method : str, optional
        Name of the method.
    in_sequence : bool
        Row after row, however long the recording is.
    progress : Progress
        Is told how far the work is.

    Returns
    -------
    tuple of FilteredLog and Evidence
        What was done, and what can be seen of it.

    Raises
    ------
    InputError
        As `strainwave.records.filter_log`.
    """
    witness = Witness()
    log = filter_log(
        path,
        out,
        options,
        joint_path=joint_path,
        method=method,
        in_sequence=in_sequence,
        progress=progress,
        watch=witness,
    )
    progress("looking at the result", 0.0)
    evidence = _gather(witness, Provenance.of_file(path), progress)
    return log, evidence


def filter_as_identified(
    identified: IdentifiedLog, options: Options
) -> tuple[FilteredLog, Evidence]:
    """Filter a recording with the joint file that was identified from it, and gather the evidence.

    Parameters
    ----------
    identified : IdentifiedLog
        What was found; its joint file is there.
    options : Options
        How the recording was read.

    Returns
    -------
    tuple of FilteredLog and Evidence
        What would be done, and what can be seen of it; no result is written.

    Raises
    ------
    InputError
        If the recording cannot be filtered with that file.
    """
    # The file names columns, rate and delay; ratio and rated torque only where both are known.
    ratio = None if "gear" in identified.sections else identified.gearing.ratio
    left_open = Options(
        ratio=ratio, rated_torque_Nm=None if ratio is None else options.rated_torque_Nm
    )
    return filter_with_evidence(identified.path, None, left_open, joint_path=identified.out)


def _gather(witness: Witness, provenance: Provenance, progress: Progress) -> Evidence:
    setting, samples = witness.setting, witness.samples
    log_time_s, cleaned = witness.excerpt()
    motion = rows_in_motion(samples, log_time_s, cleaned)
    removed = removed_orders(witness.name, setting)
    kept = _kept_orders(setting)
    assumed = tuple(float(order * setting.wave_factor) for order in ASSUMED_ORDERS)
    told = bool(removed or kept)
    lines = order_lines(motion, removed if told else assumed, kept, are_told=told)
    shown = {line.order for line in lines}
    progress("looking at the result", 0.3)
    spectrum, speed_map = order_spectrum(motion), order_map(motion)
    progress("adding contacts", 0.5)

    def run(changed: Samples) -> Cleaned:
        # The start is learned from what the method is given, contact included.
        method = InOrder(witness.build(witness.name, replace(setting, excerpt=changed)))
        return joined([method.process(changed), method.finish()])

    # A method that looks ahead gives other values near the end of an excerpt.
    plain = cleaned if witness.rows == len(samples) else run(samples)
    scene = Scene(samples, log_time_s, motion, run, setting.rated_torque_Nm, removed)
    contacts = add_contacts(scene, plain)
    flags = witness.flags.finish()
    return Evidence(
        witness.rows,
        len(samples),
        witness.rejected_rows,
        next((each.rows for each in flags if each.name == "sample_repeated"), 0),
        motion.turns,
        witness.envelope.finish(),
        spectrum,
        speed_map,
        lines,
        tuple(order for order in (*removed, *kept) if order not in shown),
        contacts,
        flags,
        provenance,
    )


def _kept_orders(setting: Setting) -> tuple[float, ...]:
    settings = setting.ripple_settings
    if settings is None:
        return ()
    orders = [each.order for each in settings.config.orders if each.keep]
    return tuple(sorted(order.numerator / order.denominator for order in orders))
