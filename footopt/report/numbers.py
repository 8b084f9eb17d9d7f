"""Numbers and names as text: each quantity has one format on the terminal, in figures and pages."""

import math

TINY = 1e-10  # of any quantity of a walk, in SI units: a rounding error


def number(value: float) -> str:
    """Four significant digits: 2.134, 12346, -2.527e-4; 0 for a rounding error, a dash for no number."""
    if not math.isfinite(value):
        return "-"
    if abs(value) < TINY:
        return "0"
    mantissa, power = f"{value:.3e}".split("e")
    if -3 <= int(power) < 5:
        return _shortest(f"{value:.{max(3 - int(power), 0)}f}")
    return f"{_shortest(mantissa)}e{int(power)}"


def quantity(value: float, unit: str) -> str:
    """A number with its unit, if it has one."""
    return f"{number(value)} {unit}".rstrip()


def counted(count: int, noun: str) -> str:
    """How many there are of a thing: 1 design, 1,000 designs."""
    return f"{count:,} {noun}{'s' * (count != 1)}"


def percent(share: float) -> str:
    """A share of 1 with two significant digits, without exponent: 0.00082 %, 12 %; a dash for no number."""
    value = 100.0 * share
    if not math.isfinite(value):
        return "-"
    digits = 1 - int(f"{value:.1e}".split("e")[1]) if abs(value) > 1e-9 else 0
    return f"{_shortest(f'{value:.{max(digits, 0)}f}')} %"


def change(name: str, value: float, base: float) -> str:
    """The change of an objective: of J_W the multiple of its base, "x 1.79", of others "-2.3 %"."""
    ratio = value / base if abs(base) > TINY else math.nan
    if not math.isfinite(ratio):
        return "-"
    return f"x {ratio:.2f}" if name == "efficiency" else f"{100 * (ratio - 1):+.1f} %"


def title(name: str) -> str:
    """The name of an objective or of a shape as a reader sees it."""
    return {"efficiency": "J_W", "reversed_l": "reversed L"}.get(name, name.replace("_", " "))


def _shortest(text: str) -> str:
    """Digits without zeros at the end."""
    return text.rstrip("0").rstrip(".") if "." in text else text
