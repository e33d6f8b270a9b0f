"""Declaration of a physical quantity: unit, meaning, default, limits. Each is declared once; all else is made from it."""

from dataclasses import dataclass, field, fields
from math import degrees, inf, isfinite

from .naming import names_checked

OUT_OF_RANGE = "{name} is {value!r}; it must be {range}"
IN_DOUBT = "{name} is {{value:g}} {unit}, {words} than {limit:g} {unit}; {hint}"
NOT_WHOLE = "{name} is {value!r}; it must be a whole number"
DEGREES = ("deg", degrees(1.0))  # `Quantity.display` of an angle


@dataclass(frozen=True)
class Quantity:
    """One number with its meaning."""

    unit: str  # "" for none
    meaning: str  # one line for people
    minimum: float = -inf  # allowed, as the maximum
    maximum: float = inf
    # of an enumeration: meanings of its choices by name, in the order of its numbers 1, 2, ...; "" names one not in use
    choices: dict = field(default_factory=dict, hash=False)
    display: tuple = ()  # (unit, factor) for people: shown value = factor times value
    # smallest and largest plausible value, apart from 0, and the doubt beyond; () for none
    usual: tuple = ()

    @property
    def numbers(self):
        """The numbers of an enumeration by their names."""
        return {name: number for number, name in enumerate(self.choices, start=1) if name}

    def range(self):
        """The allowed range in words."""
        if self.choices:
            return "one of " + ", ".join(f"{number} ({name})" for name, number in self.numbers.items())
        unit = f" {self.unit}" if self.unit else ""
        lower = f"at least {self.minimum:g}{unit}"
        upper = f"at most {self.maximum:g}{unit}"
        if self.minimum == -inf:
            return upper if self.maximum < inf else "a finite number"
        return lower if self.maximum == inf else f"{lower} and {upper}"

    def in_words(self):
        """The allowed range in words, of an enumeration with the meanings of its choices."""
        found = [f"{number} ({name}): {self.choices[name]}" for name, number in self.numbers.items()]
        return "; ".join(found) or self.range()

    def allows(self, value):
        """Whether a value is in the allowed range; never for NaN, infinities, texts and truth values."""
        if isinstance(value, str | bytes | bool):
            return False
        try:
            number = float(value)
        except (TypeError, ValueError):
            return False
        if self.choices:
            return number in self.numbers.values()
        return isfinite(number) and self.minimum <= number <= self.maximum


def doubts_in(name, quantity):
    """Of a quantity in a possibly wrong unit: (side, limit, sentence) for doubtful values beyond the limit.

    side : 1.0 above it, -1.0 below it (but not 0).  The sentence has the field `value`.
    """
    lowest, highest, hint = quantity.usual or (0.0, inf, "")
    for side, limit, words in ((-1.0, lowest, "less"), (1.0, highest, "more")):
        if 0.0 < limit < inf:
            yield side, limit, IN_DOUBT.format(name=name, unit=quantity.unit, words=words, limit=limit, hint=hint)


def is_beyond(value, side, limit):
    """Whether a value that is not 0 is beyond a limit of `doubts_in`."""
    return value != 0.0 and side * (value - limit) > 0.0


def doubts(name, value, quantity):
    """Sentences on a value with a probably wrong unit: one or none."""
    return [said.format(value=value) for *bound, said in doubts_in(name, quantity) if is_beyond(value, *bound)]


def doubts_of(record, prefix=""):
    """`doubts` of all quantities of a record; prefix : of their names."""
    pairs = quantities(record)
    return [said for name, declared in pairs for said in doubts(prefix + name, getattr(record, name), declared)]


def checked(name, value, quantity):
    """The value, or ValueError with the name of the variable, the value and the allowed range."""
    if not quantity.allows(value):
        raise ValueError(OUT_OF_RANGE.format(name=name, value=value, range=quantity.range()))
    return value


def quantity(default, unit, meaning, *limits, **more):
    """Field of a record of quantities: default, unit, meaning, minimum, maximum, and more of `Quantity`."""
    return field(default=default, metadata={"quantity": Quantity(unit, meaning, *limits, **more)})


def choice(meaning, first=1, **choices):
    """Field of a record for an enumeration: meaning, number of the default, meanings of the choices by name."""
    return quantity(first, "", meaning, choices=choices)


def quantities(record):
    """Pairs (name, Quantity) of a record or its class, in order of declaration."""
    return [(item.name, item.metadata["quantity"]) for item in fields(record) if "quantity" in item.metadata]


def can_be_given(record):
    """Pairs (name, Quantity) of the arguments of a record: its quantities, and its `instead`, which replace one."""
    return [*quantities(record), *getattr(record, "instead", {}).items()]


def documented(record):
    """Add to the docstring of a record a section with unit, meaning, range and default of each quantity; check its names."""
    defaults = {item.name: item.default for item in fields(record)}
    lines = [record.__doc__.rstrip(), "", "Parameters", "----------"]
    for name, declared in quantities(record):
        unit = f" [{declared.unit}]" if declared.unit else ""
        lines += [f"{name} : {type(defaults[name]).__name__}, default {defaults[name]!r}"]
        lines += [f"    {declared.meaning}{unit}; {declared.in_words()}"]
    record.__doc__ = "\n".join(lines)
    return names_checked(record, [name for name, _ in can_be_given(record)])


def check(record):
    """Check every quantity of a record, and replace names in enumerations by numbers; ValueError names one out of range."""
    for name, declared in quantities(record):
        value = getattr(record, name)
        if isinstance(value, str) and value in declared.numbers:
            value = declared.numbers[value]
            object.__setattr__(record, name, value)  # records are frozen
        checked(name, value, declared)
        whole = declared.choices or isinstance(record.__dataclass_fields__[name].default, int)
        if whole and int(value) != value:
            raise ValueError(NOT_WHOLE.format(name=name, value=value))


def places_of(declared):
    """Place of the first number of each input or output of a table in its array, by name."""
    places, first = {}, 0
    for each in declared:
        places[each.name] = first
        first += each.size
    return places
