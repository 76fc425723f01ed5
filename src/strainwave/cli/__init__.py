"""The command line: parse, call, print."""

from strainwave.cli.application import main

__all__ = ["main"]
