"""Numbers as people write them: 0.004, or "4 mm"."""

UNITS = {  # unit of a quantity: what else it may be given in, and the factor to the unit
    "": {"%": 0.01},
    "m": {"mm": 1e-3, "cm": 1e-2, "km": 1e3},
    "s": {"ms": 1e-3, "min": 60.0, "h": 3600.0},
    "rad": {"deg": 0.017453292519943295},
    "rad/s": {"deg/s": 0.017453292519943295, "rpm": 0.10471975511965977},
    "m/s": {"km/h": 1.0 / 3.6, "kn": 1852.0 / 3600.0},
    "kg/m3": {"g/cm3": 1000.0},
    "N": {"kN": 1e3, "MN": 1e6},
    "N.s": {"kN.s": 1e3},
}


def spellings(unit):
    """Units in which a quantity may be given, in words."""
    return ", ".join([unit or "no unit", *UNITS.get(unit, {})])


def in_si(value, unit):
    """A number, or a text like "4 mm", as a number in the unit of its quantity; ValueError says what is allowed."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"it must be a number, or a text with a unit ({spellings(unit)})")
    if not isinstance(value, str):
        return value
    amount, _, spelled = value.strip().partition(" ")
    factor = 1.0 if spelled.strip() == unit else UNITS.get(unit, {}).get(spelled.strip())
    try:
        number = float(amount)
    except ValueError:
        number = None
    if factor is None or number is None:
        raise ValueError(f"it must be a number with one of the units {spellings(unit)}")
    return number * factor
