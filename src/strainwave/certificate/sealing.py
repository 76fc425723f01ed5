"""Puts the block and its hashes into the certificate's page, and takes them out again."""

from __future__ import annotations

import hashlib
import json
import re
from typing import TYPE_CHECKING, Any, Final

from strainwave.certificate.building import FORMAT, block_hash
from strainwave.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

#: Where a page has room for the block.
SLOT: Final = '<script type="application/json" id="strainwave-certificate"></script>'
_FILLED: Final = re.compile(
    r'<script type="application/json" id="strainwave-certificate">(.*?)</script>', re.DOTALL
)
_LARGEST_BYTES: Final = 64_000_000


def sealed(page: str, block: dict[str, Any]) -> str:
    """Put the block into a page, with the hash of the block and that of the page around it.

    Parameters
    ----------
    page : str
        HTML that holds `SLOT` once.
    block : dict
        What the certificate says.

    Returns
    -------
    str
        The certificate.
    """
    assert page.count(SLOT) == 1
    content = {
        "certificate": block,
        "certificate_sha256": block_hash(block),
        "page_sha256": _page_hash(page),
    }
    # Within a script element only "<" could end it.
    text = json.dumps(content, indent=1, allow_nan=False).replace("<", "\\u003c")
    return page.replace(SLOT, SLOT.replace("></", f">{text}</"))


def read_block(path: Path) -> dict[str, Any]:
    """Read what a certificate says, and refuse one that was changed.

    Parameters
    ----------
    path : Path
        The certificate, HTML.

    Returns
    -------
    dict
        The block.

    Raises
    ------
    InputError
        If it cannot be read, is no certificate, or is not as it was issued.
    """
    text = _text(path)
    found = _FILLED.findall(text)
    if len(found) != 1:
        raise InputError(
            f"{path}: it holds {len(found) or 'no'} certificate blocks; expected the HTML file that "
            "`strainwave certify` wrote, so check the name, and give the HTML and not the PDF"
        )
    try:
        content = json.loads(found[0])
        block, told, page = (
            content[key] for key in ("certificate", "certificate_sha256", "page_sha256")
        )
        known = block["format"]
        computed = block_hash(block)
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError(
            f"{path}: its certificate block is not as strainwave writes it ({type(error).__name__}); "
            "the certificate was changed or damaged, so ask for the issued file"
        ) from error
    if known != FORMAT:
        raise InputError(
            f"{path}: its certificate block has the format {known}; expected {FORMAT}, so verify it "
            "with the strainwave that wrote it"
        )
    if computed != told:
        raise InputError(
            f"{path}: the values of this certificate were changed after it was issued (hash "
            f"{computed[:16]}..., issued as {str(told)[:16]}...); expected the issued file, so ask "
            "for it again"
        )
    if _page_hash(_FILLED.sub(lambda _: SLOT, text)) != page:
        raise InputError(
            f"{path}: the page of this certificate was changed after it was issued; expected the "
            "issued file, so ask for it again"
        )
    return dict(block)


def _page_hash(page: str) -> str:
    return hashlib.sha256(page.encode("utf-8")).hexdigest()


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise InputError(
                f"{path}: it has more than {_LARGEST_BYTES} bytes; expected a certificate, so check "
                "the name"
            )
        return path.read_bytes().decode("utf-8").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: it is not UTF-8 text; expected the HTML file that `strainwave certify` wrote, "
            "so give the HTML and not the PDF"
        ) from error
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise InputError(
            f"{path}: it cannot be read ({reason}); expected the certificate that `strainwave "
            "certify` wrote, so check the name"
        ) from error
