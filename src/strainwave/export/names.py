"""The name under which a joint stands in C++."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from strainwave.errors import InputError

if TYPE_CHECKING:
    from strainwave.joint import Joint

_IDENTIFIER: Final = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*")

#: Words of C and C++, alternative tokens, and names that compilers define as macros.
RESERVED: Final = frozenset(
    [
        "alignas",
        "alignof",
        "and",
        "and_eq",
        "asm",
        "auto",
        "bitand",
        "bitor",
        "bool",
        "break",
        "case",
        "catch",
        "char",
        "char8_t",
        "char16_t",
        "char32_t",
        "class",
        "compl",
        "concept",
        "const",
        "consteval",
        "constexpr",
        "constinit",
        "const_cast",
        "continue",
        "co_await",
        "co_return",
        "co_yield",
        "decltype",
        "default",
        "delete",
        "do",
        "double",
        "dynamic_cast",
        "else",
        "enum",
        "explicit",
        "export",
        "extern",
        "false",
        "float",
        "for",
        "friend",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "mutable",
        "namespace",
        "new",
        "noexcept",
        "not",
        "not_eq",
        "nullptr",
        "operator",
        "or",
        "or_eq",
        "private",
        "protected",
        "public",
        "register",
        "reinterpret_cast",
        "requires",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "static_assert",
        "static_cast",
        "struct",
        "switch",
        "template",
        "this",
        "thread_local",
        "throw",
        "true",
        "try",
        "typedef",
        "typeid",
        "typename",
        "typeof",
        "union",
        "unsigned",
        "using",
        "virtual",
        "void",
        "volatile",
        "wchar_t",
        "while",
        "xor",
        "xor_eq",
        "arm",
        "linux",
        "unix",
        "i386",
        "NULL",
        "EOF",
    ]
)


def joint_identifier(joint: Joint, given: str | None = None) -> str:
    """Give the name of a joint's namespace and header.

    Parameters
    ----------
    joint : Joint
        The joint.
    given : str, optional
        A name that a person chose; without, the joint's own.

    Returns
    -------
    str
        A C++ identifier.

    Raises
    ------
    InputError
        If the name is none.
    """
    name = joint.identity.name if given is None else given
    if _IDENTIFIER.fullmatch(name) and name not in RESERVED and len(name) <= 100:
        return name
    where = f'joint "{name}": the name is' if given is None else f"--name {name!r}: it is"
    raise InputError(
        f"{where} no name for a C++ namespace; expected letters, digits and single underscores "
        "between them, a letter first, no word of C++, so give another one with --name"
    )
