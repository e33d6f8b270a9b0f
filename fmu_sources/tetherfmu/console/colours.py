"""Colours of pictures: one colour per variant everywhere, from the colour-blind safe palette of Okabe and Ito (2008).

An example takes them as `from tetherfmu.console.colours import COLOUR`.
"""

ORANGE, SKY_BLUE, GREEN, YELLOW = "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILLION, PURPLE, BLACK, GREY = "#0072B2", "#D55E00", "#CC79A7", "#000000", "#808080"

#: colour of a variant by its name
COLOUR = {
    "straight": ORANGE,
    "catenary": GREEN,
    "quasi_steady": BLUE,
    "dynamic": VERMILLION,
    "dynamic_free": PURPLE,
}
#: colour of what a variant is compared with: a formula, a peer, an experiment
REFERENCE = GREY
