"""Lines of a system as its shared winches turn them, and what those winches give."""

from dataclasses import replace

import numpy as np

from tetherfmu.records.systems import shares_of
from tetherfmu.runtime import layout as at
from tetherfmu.wiring.winches import BY_LENGTH, carriers_of

from .system_results import WinchEnergy, WinchOutputs


class Turned:
    """Lines of a system as its shared winches turn them.

    told (modified) : what each winch is told now, its input, an array.
    """

    def __init__(self, winches, lines):
        names = [line.name for line in lines]
        held, self._ratios, self._shares = shares_of(winches)
        self.carriers = {name: names.index(line) for name, line in carriers_of(winches).items()}
        self.winches, self.held = winches, [names.index(name) for name in held]
        self._first_lengths = np.array([sum(each.initial_length for each in lines[k].line.tethers) for k in self.held])
        self._by_length = np.array([each.control == BY_LENGTH for each in winches], dtype=bool)
        self.told = np.zeros(len(winches))

    def ratios(self):
        """Ratios of all lines that winches hold, a flat array: they tell systems apart."""
        return self._ratios.ravel()

    def by(self, what):
        """Names of the winches with this input."""
        return [each.name for each in self.winches if each.input == what]

    def place_of(self, name):
        """Place of a winch with this name."""
        return [each.name for each in self.winches].index(name)

    def put(self, told, rows):
        """Let the lines be turned as winches are told, (..., winches).

        rows : views (..., INPUTS) of the inputs of all lines (modified).
        """
        for name, k in self.carriers.items():
            rows[k][..., at.WINCH_FORCE] = told[..., self.place_of(name)]
        for k, ratios, first in zip(self.held, self._ratios, self._first_lengths, strict=True):
            if self.winches[np.flatnonzero(ratios)[0]].name in self.carriers:
                continue
            is_by_length = any(self._by_length[ratios != 0.0])
            terms = (ratio * told[..., j] for j, ratio in enumerate(ratios) if ratio)
            turned = sum(terms, start=first if is_by_length else 0.0)
            rows[k][..., at.WINCH_LENGTH if is_by_length else at.REEL_OUT_SPEED] = turned

    def put_starts(self, speeds, rows):
        """Let winches that are not controlled by speed start with these [m/s], by name; rows (modified) : as in `put`."""
        for name, k in self.carriers.items():
            rows[k][..., at.REEL_OUT_SPEED] = speeds[name]
        for k, ratios in zip(self.held, self._ratios, strict=True):
            if any(self._by_length[ratios != 0.0]):
                held = zip(ratios, self.winches, strict=True)
                rows[k][..., at.REEL_OUT_SPEED] = sum(ratio * speeds[each.name] for ratio, each in held if ratio)

    def outputs(self, lines):
        """`WinchOutputs` of each winch by its name; lines : outputs of all lines (..., outputs), a list."""
        if not self.winches:
            return {}
        speeds = np.stack([lines[k][..., at.WINCH_SPEED] for k in self.held], axis=-1) @ self._shares.T
        lengths = np.stack([lines[k][..., at.TETHER_LENGTH] for k in self.held], axis=-1) - self._first_lengths
        payouts = lengths @ self._shares.T
        return {each.name: WinchOutputs(speeds[..., j][()], payouts[..., j][()]) for j, each in enumerate(self.winches)}


def energies_of(winches, energies, states):
    """`WinchEnergy` of the winches that are controlled by force, by name.

    energies, states : of lines by name, those of its first portion.
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
    """`Energy` of a line that a winch holds, which has no drum of its own."""
    return replace(energy, drum=0.0, drum_power=0.0, motor_power=0.0, friction_loss=0.0)
