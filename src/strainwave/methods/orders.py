"""Which orders a method removes, in cycles per motor turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from fractions import Fraction

    from strainwave._core import Rational
    from strainwave.methods.setting import Setting

#: Methods of the ripple filter's model.
RIPPLE_METHODS = ("ripple", "smoother")


def removed_orders(name: str, setting: Setting) -> tuple[float, ...]:
    """Name the lines that a method takes out of the torque.

    Parameters
    ----------
    name : str
        One of `strainwave.methods.registry.METHOD_NAMES`.
    setting : Setting
        What the method is built from.

    Returns
    -------
    tuple of float
        Cycles per motor turn, rising; none for a method that follows no order.
    """
    # Imported here for the same reason as in the registry.
    if name in RIPPLE_METHODS:
        from strainwave.methods.ripple import ripple_settings  # noqa: PLC0415

        learned = ripple_settings(setting).config.orders
        return _values(each.order for each in learned if not each.keep)
    if name == "notch":
        from strainwave.methods.notch import notch_orders  # noqa: PLC0415

        return _values(notch_orders(setting))
    if name == "oscillator" and setting.joint is not None:
        from strainwave.configuration import oscillator_filter_of  # noqa: PLC0415

        return _values(oscillator_filter_of(setting.joint).orders)
    if name in ("taghirad1999", "taghirad1999-4"):
        from strainwave.filter import oscillator_preset  # noqa: PLC0415

        return _values(oscillator_preset(name, setting.ratio or 1).orders)
    return ()


def _values(orders: Iterable[Rational | Fraction]) -> tuple[float, ...]:
    return tuple(sorted(order.numerator / order.denominator for order in orders))
