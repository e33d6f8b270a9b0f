"""Advice, reports and pages as text: numbers for people, and the templates (`*.j2`) beside this file."""

from pathlib import Path

from tetherfmu.study.measuring.tables import circumstances, templates_in


def percent(value):
    """Text of a share in percent, two digits."""
    return f"{100.0 * value:.2g} %"


def factor(cost):
    """Text of how many times faster than real time a cost per simulated second is, two digits; a dash if not known."""
    return f"{float(f'{1.0 / cost:.2g}'):.0f}" if cost else "-"


def hyphenated(variant):
    """Name of a variant in a sentence or a figure."""
    return variant.replace("_", "-")


TEMPLATES = templates_in(Path(__file__).parent)
TEMPLATES.filters |= {"percent": percent, "factor": factor, "hyphenated": hyphenated}


def rendered(template, **facts):
    """Text of a template that is filled with facts and the circumstances."""
    return TEMPLATES.get_template(template).render(facts, circumstances=circumstances())
