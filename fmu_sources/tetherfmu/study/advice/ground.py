"""Advice about the ground: how much of the tether lies on it, or how far below it the tether hangs."""

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.plausibility import GROUND_IGNORED, SENTENCES, UNDER
from tetherfmu.study.measuring.tables import percent

_, _, ANY_DEPTH = SENTENCES[GROUND_IGNORED].partition("}")  # the part of the sentence after the depth


def is_of_ground(sentence):
    """Whether a sentence of `Run.implausible` equals the one of `hanging`, with any depth."""
    return sentence.endswith(ANY_DEPTH)


def lying(flown):
    """A text on the part of the tether on the ground in a flight; empty if none ever is."""
    lengths, lies = flown.of("tether_length"), flown.of("grounded_length")
    if not lies.any():
        return ""
    most = np.argmax(lies)
    return (
        f"the tether lies on the ground during {percent(np.mean(lies > 0.0))} of the flight, with up to {lies[most]:.3g} m "
        f"of its {lengths[most]:.3g} m"
    )


def hanging(scene, flown):
    """Sentences on a tether that hangs below a ground without contact while both of its ends are above."""
    if scene.ground.ground_contact == at.FLAT:
        return
    depth = scene.ground.ground_height - flown.shape[..., 2]
    below = np.where((depth[:, [0, -1]] <= 0.0).all(axis=1), depth.max(axis=1), 0.0)
    if below.max() > UNDER:
        yield (
            f"the tether hangs up to {below.max():.3g} m below ground.height, during {percent(np.mean(below > 0.0))} of the "
            'flight; with contact = "flat" in the table [ground] it lies on the ground'
        )
