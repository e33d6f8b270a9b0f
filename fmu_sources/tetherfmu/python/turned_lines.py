"""Lines of a system driven by its shared winches, and the results of those winches."""

from dataclasses import replace

import numpy as np

from tetherfmu.records.checked_systems import shares_of
from tetherfmu.runtime import layout as at
from tetherfmu.wiring.fmu import held_of
from tetherfmu.wiring.winches import carriers_of

from .system_results import WinchEnergy, WinchOutputs


class Turned:
    """Lines of a `System` driven by its shared winches.

    told (modified) : present input of each winch, an array.  ratios : of lines and winches (lines,
    winches); they distinguish systems.
    """

    def __init__(self, system):
        self.winches, lines = system.winches, {line.name: line for line in system.lines}
        self._held, self.ratios, self._shares = shares_of(system.winches)
        lengths = {name: lines[name].initial_length for name in self._held}
        self._first_lengths, self.told = np.array([*lengths.values()]), np.zeros(len(system.winches))
        self._first, self._terms, self._starting = {}, {}, {}  # by places of inputs: number, pairs of a winch and its factor
        winches = {each.name: (j, each.input) for j, each in enumerate(system.winches)}
        for place, name, *_, factor in held_of(system):
            owner, _, what = name.partition(".")
            if owner in lengths:
                self._first[place] = lengths[owner]
            else:
                terms = self._terms if what == winches[owner][1] else self._starting
                terms.setdefault(place, []).append((winches[owner][0], factor))

    def put(self, inputs, told, speeds=None):
        """Set the inputs of lines from the inputs of winches, (..., winches).

        inputs : (..., size) of all lines (modified).  speeds : start speeds of winches without speed control,
        likewise; None after the start.
        """
        for place, terms in self._terms.items():
            inputs[..., place] = sum((factor * told[..., j] for j, factor in terms), start=self._first.get(place, 0.0))
        for place, terms in self._starting.items() if speeds is not None else ():
            inputs[..., place] = sum(factor * speeds[..., j] for j, factor in terms)

    def outputs(self, values):
        """`WinchOutputs` of each winch by its name; values : outputs of all lines by name (..., outputs)."""
        if not self.winches:
            return {}
        speeds = np.stack([values[name][..., at.WINCH_SPEED] for name in self._held], axis=-1) @ self._shares.T
        lengths = np.stack([values[name][..., at.TETHER_LENGTH] for name in self._held], axis=-1) - self._first_lengths
        payouts = lengths @ self._shares.T
        return {each.name: WinchOutputs(speeds[..., j][()], payouts[..., j][()]) for j, each in enumerate(self.winches)}


def energies_of(winches, energies, states):
    """`WinchEnergy` of the force-controlled winches, by name.

    energies, states : of lines by name, from the first portion.
    """
    found = {}
    for name, carrier in carriers_of(winches).items():
        winch = next(each for each in winches if each.name == name)
        pull = sum(ratio * states[line][at.TENSION_AT_DRUM] for line, ratio in winch.lines.items())
        own = energies[carrier]
        rope_power = float(pull * states[carrier][at.DRUM_SPEED])
        found[name] = WinchEnergy(own.drum, rope_power, own.motor_power, own.friction_loss)
    return found


def without_drum(energy):
    """`Energy` of a line on a shared winch, without a drum of its own."""
    return replace(energy, drum=0.0, drum_power=0.0, motor_power=0.0, friction_loss=0.0)
