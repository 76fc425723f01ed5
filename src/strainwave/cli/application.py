"""The command `strainwave`: its subcommands, and how it ends when it cannot do what was asked."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Final

import cyclopts

import strainwave
from strainwave.cli.calibrate import calibrate_app
from strainwave.cli.calibrate_fluctuation import fluctuation
from strainwave.cli.calibrate_misalignment import calibrate_misalignment
from strainwave.cli.calibrate_plan import calibrate_plan
from strainwave.cli.calibrate_thermal import calibrate_thermal
from strainwave.cli.calibrate_torque import calibrate_torque_command
from strainwave.cli.calibrate_tune import tune
from strainwave.cli.certify import certify
from strainwave.cli.demo import demo
from strainwave.cli.design import design_app
from strainwave.cli.export import export_command
from strainwave.cli.fidelity import fidelity
from strainwave.cli.filter import filter_command
from strainwave.cli.identify import identify_command
from strainwave.cli.joint import joint_app
from strainwave.cli.tare import tare_command
from strainwave.cli.verify import verify
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Exit code where what a person gave cannot be used.
UNUSABLE_INPUT: Final = 2
#: Exit code where nobody reads the output any more: that of a program which the signal ends.
READER_GONE: Final = 128 + 13

app = cyclopts.App(
    name="strainwave",
    help="Clean joint torque from the strain gauges inside a strain wave gear.",
    help_format="markdown",
    default_parameter=cyclopts.Parameter(negative=()),
    version=lambda: strainwave.__version__,
)
# In the order of `--help`, which is that of the work: a look, filtering, building a sensor,
# handing it over.
app.command(demo)
app.command(identify_command, name="identify")
app.command(filter_command, name="filter")
app.command(fidelity)
app.command(design_app)
calibrate_app.command(fluctuation)
calibrate_app.command(tune)
calibrate_app.command(calibrate_plan, name="plan")
calibrate_app.command(calibrate_torque_command, name="torque")
calibrate_app.command(calibrate_thermal, name="thermal")
calibrate_app.command(calibrate_misalignment, name="misalignment")
app.command(calibrate_app)
app.command(tare_command, name="tare")
app.command(joint_app)
app.command(export_command, name="export")
app.command(certify)
app.command(verify)


def _list_as_registered(commands: cyclopts.App) -> None:
    for place, name in enumerate(name for name in commands if not name.startswith("-")):
        commands[name].sort_key = place


for _commands in (app, calibrate_app, joint_app):
    _list_as_registered(_commands)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and end the process.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows the command's name; the process's own arguments without.
    """
    try:
        try:
            _run(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        # Who reads, such as `head`, has enough: what is left goes nowhere, without a word.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(READER_GONE)


def _run(arguments: Sequence[str] | None) -> None:
    try:
        app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except cyclopts.CycloptsError as error:
        words = " ".join(str(error).split()).rstrip("., ")
        _refuse(f"{words}; see `strainwave --help`")
    except InputError as error:
        _refuse(str(error))
    except KeyboardInterrupt:
        sys.exit(130)


def _refuse(message: str) -> None:
    sys.stderr.write(f"strainwave: {message}\n")
    sys.exit(UNUSABLE_INPUT)
