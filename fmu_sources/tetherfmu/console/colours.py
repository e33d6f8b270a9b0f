"""Colours of pictures: one colour per variant everywhere, from the colour-blind safe palette of Okabe and Ito (2008).

Examples import them by `from tetherfmu.console.colours import COLOUR`.
"""

from tetherfmu.runtime.variants import TABLE, class_name

# #: the palette, by the variant names in `runtime.variants`
PALETTE = {
    "orange": "#E69F00",
    "sky blue": "#56B4E9",
    "green": "#009E73",
    "blue": "#0072B2",
    "vermillion": "#D55E00",
    "purple": "#CC79A7",
}
ORANGE, SKY_BLUE, GREEN, BLUE, VERMILLION, PURPLE = PALETTE.values()
BLACK, GREY = "#000000", "#808080"

#: colour of a variant by its name
COLOUR = {each.name: PALETTE[each.colour] for each in TABLE}
#: colour of a component of a vector, and of its magnitude: no variant has it; two are from the palette of Tol (2021)
COMPONENTS = {"x": SKY_BLUE, "y": "#332288", "z": "#999933", "magnitude": BLACK}
# #: colour of references: a formula, a peer, an experiment
REFERENCE = GREY
#: colour of the ground under a tether
GROUND = "#8C6D46"
OF_FMUS = {class_name(variant): colour for variant, colour in COLOUR.items()}
# for anything else in order: after the palette three of Tol's (2021)
OTHERS = (VERMILLION, BLUE, GREEN, ORANGE, PURPLE, SKY_BLUE, "#882255", "#332288", "#999933")


def coloured(flights):
    """Triples (name, flight, colour) of a dict: the colour of the FMU with that name, or by position if there is none."""
    for number, (name, flight) in enumerate(flights.items()):
        yield name, flight, OF_FMUS.get(name, OTHERS[number % len(OTHERS)])
