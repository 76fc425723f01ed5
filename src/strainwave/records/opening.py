"""Opens a recording by the end of its name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from strainwave.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.records.raw import Recording

CSV_ENDINGS: Final = (".csv", ".tsv", ".txt")
PARQUET_ENDINGS: Final = (".parquet", ".pq")


def open_recording(path: Path) -> Recording:
    """Open a recording.

    Parameters
    ----------
    path : Path
        A CSV file (.csv, .tsv, .txt) or a Parquet file (.parquet, .pq).

    Returns
    -------
    Recording
        The recording, ready to be read.

    Raises
    ------
    InputError
        If there is no such file, or it is none of these.
    """
    if path.is_dir():
        raise InputError(f"{path}: it is a folder; expected a recording, so name a file in it")
    if not path.exists():
        raise InputError(f"{path}: there is no such file; expected a recording, so check the name")
    ending = path.suffix.lower()
    # Each kind loads its reader: who reads Parquet does not wait for that of text.
    if ending in CSV_ENDINGS:
        from strainwave.records.csv_reader import CsvRecording  # noqa: PLC0415
        from strainwave.records.kept import KeptRecording  # noqa: PLC0415

        # Text takes longer to read than Parquet does twice.
        return KeptRecording(CsvRecording(path))
    if ending in PARQUET_ENDINGS:
        from strainwave.records.parquet_reader import ParquetRecording  # noqa: PLC0415

        return ParquetRecording(path)
    raise InputError(
        f"{path}: the name ends in {path.suffix!r}; expected "
        f"{', '.join((*CSV_ENDINGS, *PARQUET_ENDINGS))}, so convert the recording or rename it"
    )
