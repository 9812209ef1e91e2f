"""Figures as the light bench's tables print them: "-" for what is not known."""


def degrees(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}°"


def percent(value: float | None) -> str:
    return "-" if value is None else f"{value:.0%}"


def fraction(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
