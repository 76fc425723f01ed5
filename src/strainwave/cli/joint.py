"""`strainwave joint`: make a joint file, or say what one holds and whether it is right."""

from __future__ import annotations

from pathlib import Path

import cyclopts

joint_app = cyclopts.App(name="joint", help="Make a joint file, or check one.")


@joint_app.command
def new(path: Path, /, *, name: str, json: bool = False) -> None:
    """Make a joint file that holds nothing but a name; other commands fill its sections.

    Example: strainwave joint new shoulder.toml --name "left shoulder"

    Parameters
    ----------
    path : Path
        The file to write; it must not exist yet.
    name : str
        Name of the joint.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_json, result_console
    from strainwave.errors import InputError
    from strainwave.joint import canonical_hash, new_joint, write_joint

    if path.exists():
        raise InputError(
            f"{path}: it exists already; expected a new file, choose another name or remove it"
        )
    joint_file = new_joint(name)
    write_joint(joint_file, path)
    digest = canonical_hash(joint_file.joint)
    if json:
        print_json({"path": str(path), "name": name, "hash": digest})
    else:
        result_console().print(f"{path}: joint {name!r}, hash {digest}", soft_wrap=True)


@joint_app.command
def check(path: Path, /, *, json: bool = False) -> None:
    """Read a joint file, and say which sections it holds and what its hash is.

    Example: strainwave joint check shoulder.toml

    Parameters
    ----------
    path : Path
        The joint file.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_json, result_console
    from strainwave.configuration import verify
    from strainwave.errors import InputError
    from strainwave.joint import SECTION_NAMES, canonical_hash, read_joint, section_hash

    joint = read_joint(path).joint
    try:
        verify(joint)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    present = {
        name: getattr(joint, name) for name in SECTION_NAMES if getattr(joint, name) is not None
    }
    digest = canonical_hash(joint)
    if json:
        print_json(
            {
                "path": str(path),
                "name": joint.identity.name,
                "hash": digest,
                "sections": {
                    name: {
                        "input": section.provenance.input,
                        "created": section.provenance.created.isoformat(),
                        "version": section.provenance.version,
                        "hash": section_hash(joint, name),
                    }
                    for name, section in present.items()
                },
                "history": [
                    {
                        "section": entry.section,
                        "change": entry.change,
                        "changed_at": entry.changed_at.isoformat(),
                        "input": entry.input,
                        "previous_input": entry.previous_input,
                        "previous_hash": entry.previous_sha256,
                    }
                    for entry in joint.history or ()
                ],
            }
        )
        return
    console = result_console()
    console.print(f"{path}: joint {joint.identity.name!r}, hash {digest}", soft_wrap=True)
    for name in SECTION_NAMES:
        if name in present:
            provenance = present[name].provenance
            console.print(
                f"  {name:<20} from {provenance.input}, {provenance.created:%Y-%m-%d %H:%M} UTC, "
                f"by strainwave {provenance.version}",
                soft_wrap=True,
            )
        else:
            console.print(f"  {name:<20} not known yet")
    for entry in joint.history or ():
        console.print(
            f"  {entry.changed_at:%Y-%m-%d %H:%M} UTC: {entry.section} {entry.change}, from "
            f"{entry.input} (before: {entry.previous_input})",
            soft_wrap=True,
        )
