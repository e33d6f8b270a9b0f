"""Make the reference data anew and compare: `python tests/reference/make_reference.py [NAME ...] [--write DIR]`.

Point masses m_i on segments of unstretched length l0, with the equations written here and no code of the package:

    r = x_q - x_p,   l = |r|,   e = r/l,   u = v_q - v_p
    tension     T = k (l - l0) (times `slack` where l <= l0) + c e.u
    half drag   F = rho cd d l |w| w/4,   w = W - (W.e) e,   W = wind - (v_p + v_q)/2
    motion      m_i v_i' = sum of the tensions and half drags of its segments - m_i g

A tether has k = EA/l0, c = D/l0, and masses mu l0, half of that at its ends; l0 and with it k, c, m_i follow the reel-out.
The damper does not see the reel-out (`stretch_rate`). Needs numpy and scipy; all files take some minutes.

An inextensible chain (`Inextensible`) has the tensions at which the lengths stay: of each segment, e.(v_q' - v_p') =
-(u.u - (e.u)^2)/l, linear in the tensions.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

FOLDER = Path(__file__).resolve().parent
SOLVER = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-12}  # m and m/s
G, RHO, CD = 9.81, 1.225, 0.958
EA, D, DIAMETER, DENSITY = 614600.0, 473.0, 0.004, 724.0
SLACK = 0.01 / 1.01  # stiffness of a slack segment over that of a taut one: s/(1 + s) with s = 0.01, as in Tethers.jl
MU = DENSITY * np.pi * DIAMETER**2 / 4.0
UP = np.array([0.0, 0.0, 1.0])


@dataclass
class Chain:
    """Masses on segments; the first is held, `last` says where the last one is led (None: it is free)."""

    x: np.ndarray  # of the nodes at the start [m], (nodes, 3)
    v: np.ndarray  # [m/s]
    segment: object  # of the time: l0 [m], k [N/m], c [N s/m], masses of all nodes [kg]
    slack: float = 0.0  # stiffness of a slack segment over that of a taut one
    wind: tuple | None = None  # [m/s]; None: no air
    whole_damper: bool = False  # on u, not on its part along the segment
    last: object = None  # of the time: position [m] and velocity [m/s]
    held: bool = True  # the first node
    gravity: float = G  # [m/s2]
    width: float = CD * DIAMETER  # drag coefficient times diameter [m]

    def forces(self, time, x, v):
        """Tension times e and half drag [N] of all segments; the masses [kg]."""
        l0, k, c, masses = self.segment(time)
        r, u = x[1:] - x[:-1], v[1:] - v[:-1]
        length = np.sqrt((r * r).sum(axis=1))[:, None]
        e = r / length
        spring = k * (length - l0) * np.where(length > l0, 1.0, self.slack)
        pull = spring * e + (c * u if self.whole_damper else c * (e * u).sum(axis=1)[:, None] * e)
        half = np.zeros_like(r)
        if self.wind is not None:
            w = self.wind - 0.5 * (v[1:] + v[:-1])
            w = w - (w * e).sum(axis=1)[:, None] * e
            half = 0.25 * RHO * self.width * length * np.sqrt((w * w).sum(axis=1))[:, None] * w
        return pull, half, masses

    def accelerations(self, time, x, v):
        """Of all nodes [m/s2], as if none were held."""
        force = np.zeros_like(x)
        pull, half, masses = self.forces(time, x, v)
        force[:-1] += pull + half
        force[1:] += half - pull
        return force / masses[:, None] - (0.0, 0.0, self.gravity)

    def rates(self, time, state):
        x, v = state.reshape(2, -1, 3).copy()
        if self.last:
            x[-1], v[-1] = self.last(time)
        a = self.accelerations(time, x, v)
        if self.held:
            a[0] = 0.0
        if self.last:
            v[-1] = a[-1] = 0.0  # its own motion is that of `last`
        return np.concatenate((v, a)).ravel()

    def motion(self, times):
        """Positions and velocities at times [s], two arrays (times, nodes, 3)."""
        start = np.concatenate((self.x, self.v)).ravel()
        solved = solve_ivp(self.rates, (times[0], times[-1]), start, t_eval=times, **SOLVER)
        assert solved.success, solved.message
        x, v = solved.y.T.reshape(len(times), 2, -1, 3).transpose(1, 0, 2, 3).copy()
        if self.last:
            for row, time in enumerate(times):
                x[row, -1], v[row, -1] = self.last(time)
        return x, v

    def at_rest(self):
        """Positions of the nodes in equilibrium between the two ends [m]: slid down to it by Radau, then Powell's method."""
        none = np.zeros_like(self.x)

        def missing(inner):
            x = np.vstack((self.x[:1], inner.reshape(-1, 3), self.x[-1:]))
            return self.accelerations(0.0, x, none)[1:-1].ravel()

        slid = solve_ivp(lambda _, inner: missing(inner), (0.0, 1e4), self.x[1:-1].ravel(), "Radau", rtol=1e-6, atol=1e-9)
        found = root(missing, slid.y[:, -1], method="hybr", tol=1e-14)
        self.x[1:-1] = found.x.reshape(-1, 3)
        _, k, _, masses = self.segment(0.0)
        rounding = 2.3e-16 * np.abs(self.x).max() * k / masses.min()  # of a position, in the spring
        assert np.abs(missing(found.x)).max() < 10.0 * rounding, found.message
        return self.x


def tether(length, n, speed=0.0):
    """Function `segment` of a tether of unstretched length [m] that is reeled out at a speed [m/s]."""
    shares = np.concatenate(([0.5], np.ones(n - 1), [0.5]))

    def segment(time):
        l0 = (length + speed * time) / n
        return l0, EA / l0, D / l0, MU * l0 * shares

    return segment


def sagging(end, length, n, load=-UP):
    """Start of a search for an equilibrium: a parabola of about this length [m] to `end` [m], bent along a load."""
    part = np.linspace(0.0, 1.0, n + 1)[:, None]
    chord = np.linalg.norm(end)
    sag = chord * np.sqrt(3.0 / 8.0 * max(length / chord - 1.0, 0.0))
    return part * np.asarray(end) + 4.0 * sag * part * (1.0 - part) * load


def springs(*masses, length=10.0, k=50.0, c=0.5):
    """Function `segment` of springs and dampers that stay as they are."""
    return lambda time: (length, k, c, np.array(masses))


OFF = np.array([np.sin(np.pi / 10.0), 0.0, np.cos(np.pi / 10.0)])


def down(n, length, direction=UP):
    """Nodes of a straight chain of n segments [m] that hangs from the origin."""
    return -np.arange(n + 1.0)[:, None] * length * direction


def tutorial(number):
    """A scene of the tutorial of Tethers.jl as a `Chain`, and its duration [s]."""
    if number == 1:
        return Chain(np.zeros((1, 3)), 50.0 * UP[None], lambda _: (1.0, 0.0, 0.0, np.ones(1)), held=False), 10.0
    if number == 2:
        return Chain(down(1, 10.0), np.zeros((2, 3)), springs(1.0, 1.0), slack=1.0), 10.0
    if number == 3:
        return Chain(down(1, 10.0), 4.0 * UP * [[0.0], [1.0]], springs(1.0, 1.0)), 10.0
    if number == 4:
        return Chain(down(2, 10.0), 2.0 * UP * [[0.0], [1.0], [2.0]], springs(1.0, 1.0, 1.0), whole_damper=True), 10.0
    if number == 5:
        masses = springs(0.25, 0.5, 0.5, 0.5, 0.5, 0.25, length=5.0)
        return Chain(down(5, 5.0, OFF), -0.08 * down(5, 5.0, OFF), masses), 10.0
    if number in (6, 7):
        start, segment = down(5, 10.0, OFF), tether(50.0, 5, speed=2.0)
        wind, rate = (None, 0.0) if number == 6 else ((2.0, 0.0, 0.0), 2.0 / 50.0)
        return Chain(start, rate * start, segment, SLACK, wind), 10.0
    at_rest = Chain(sagging((-40.0, 0.0, -47.0), 70.0, 10), np.zeros((11, 3)), tether(70.0, 10), SLACK, (2.0, 0.0, 0.0))
    return Chain(at_rest.at_rest(), at_rest.v, tether(70.0, 10, speed=0.3), SLACK, at_rest.wind), 30.0


def tutorial_columns(number):
    """Columns of `tether_0<number>.csv`."""
    chain, duration = tutorial(number)
    times = np.arange(round(duration / 0.02) + 1) / 50.0
    x, v = chain.motion(times)
    x = x[:, 1:] if number == 2 else x  # its file has the mass only
    names = {f"p{i}_{axis}": x[:, i, j] for i in range(x.shape[1]) for j, axis in enumerate("xyz")}
    return {"time": times, **names, **{f"v_last_{axis}": v[:, -1, j] for j, axis in enumerate("xyz")}}


def kite(time, rate=0.05):
    """Position [m] and velocity [m/s] on a cone of half angle 10 deg, 500 m long, turned by 70 deg about x."""
    radius, phase, tilt = 500.0 * np.sin(np.radians(10.0)), rate * time, np.radians(70.0)
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    position = np.array([radius * np.cos(phase), radius * np.sin(phase), 500.0 * np.cos(np.radians(10.0))])
    return turn @ position, turn @ (radius * rate * np.array([-np.sin(phase), np.cos(phase), 0.0]))


def circle_columns():
    """Columns of `sceneB_n20_w0.1.csv`; end forces without the weight of the end nodes."""
    n, length, times = 20, 525.0, 0.5 * np.arange(252)
    start = sagging(kite(0.0)[0], length, n)
    chain = Chain(start, np.zeros((n + 1, 3)), tether(length, n), SLACK, wind=(0.1, 0.0, 0.0), last=kite)
    chain.at_rest()
    x, v = chain.motion(times)
    columns = {"time": times}
    ends = [chain.forces(*row)[:2] for row in zip(times, x, v, strict=True)]
    forces = {"Fgnd": [pull[0] + half[0] for pull, half in ends], "Fkite": [half[-1] - pull[-1] for pull, half in ends]}
    for name, rows in forces.items():
        columns |= {f"{name}_{axis}": np.array(rows)[:, j] for j, axis in enumerate("xyz")}
    return columns | {f"p{i}_{axis}": x[:, i, j] for i in range(n + 1) for j, axis in enumerate("xyz")}


def wind_loaded_columns():
    """Columns of `wind_loaded.csv` that are forces [N] or the sag [m]; the tethers are those of the stored file."""
    found = {}
    for row in np.genfromtxt(FOLDER / "wind_loaded.csv", delimiter=",", names=True, deletechars=""):
        for name, value in held_in_wind(*(row[name] for name in ("L0", "r", "d_mm", "v_wind"))).items():
            found.setdefault(name, []).append(value)
    return {name: np.array(values) for name, values in found.items()}


def held_in_wind(length, ratio, diameter, wind):
    """A tether of `length` [m] over a chord of length/ratio, a diameter [mm], in a wind [m/s] across it, without gravity."""
    chord, width, stiffness = length / ratio, CD * diameter * 1e-3, EA * (diameter / 4.0) ** 2
    load = 0.5 * RHO * width * wind**2
    found = {"EA": stiffness, "w": load, "L": chord}
    for n in (6, 20, np.inf):  # (r/EA) F^3 + (r - 1) F^2 = (1 - 1/n^2) w^2 chord^2/24
        roots = np.roots([ratio / stiffness, ratio - 1.0, 0.0, -(1.0 - 1.0 / n**2) * (load * chord) ** 2 / 24.0])
        found[f"F_formula_n{n}" if n < np.inf else "F_formula_inf"] = roots[np.isreal(roots)].real.max()
    for n in (6, 20):
        l0 = length / n
        start = sagging((chord, 0.0, 0.0), max(length, 1.0005 * chord), n, np.array([0.0, 1.0, 0.0]))
        springs_only = lambda _, l0=l0, n=n: (l0, stiffness / l0, 0.0, np.ones(n + 1))  # noqa: E731
        chain = Chain(start, np.zeros_like(start), springs_only, 1.0, (0.0, wind, 0.0), gravity=0.0, width=width)
        x = chain.at_rest()
        pull, half, _ = chain.forces(0.0, x, chain.v)
        tensions = np.linalg.norm(pull, axis=1)
        found[f"F_mean_chain_n{n}"] = tensions.mean()
        if n == 6:
            found |= {"Tmin_n6": tensions.min(), "Tmax_n6": tensions.max(), "sag_n6": x[:, 1].max()}
            for end, (along, across, _) in {"Fgnd": pull[0] + half[0], "Ftop": half[-1] - pull[-1]}.items():
                found |= {f"{end}_lat_n6": across, f"{end}_axial_n6": along}
    return found


def swaying(end):
    """Function of the time: position [m], velocity [m/s] and acceleration [m/s2] of an end that sways along y."""
    along = np.array([0.0, 2.0, 0.0])
    return lambda time: (end + along * (1.0 - np.cos(time)), along * np.sin(time), along * np.cos(time))


@dataclass
class Inextensible:
    """A hanging chain of n rods in wind, the first node held, the last one led."""

    n: int
    length: float  # [m]
    last: object  # of the time: position [m], velocity [m/s] and acceleration [m/s2]
    wind: tuple = (8.0, 0.0, 0.0)  # [m/s]

    def loads(self, x, v):
        """Weight and drag of inner nodes [N]; rates of the vectors between nodes [m/s], their directions, lengths [m]."""
        rods = Chain(x, v, lambda _: (self.length / self.n, 0.0, 0.0, None), wind=self.wind)
        _, half, _ = rods.forces(0.0, x, v)
        r = x[1:] - x[:-1]
        length = np.linalg.norm(r, axis=1)
        return half[1:] + half[:-1] - MU * self.length / self.n * G * UP, v[1:] - v[:-1], r / length[:, None], length

    def tensions(self, time, x, v):
        """Tensions [N], and the accelerations of the inner nodes [m/s2]."""
        mass, (load, u, e, length) = MU * self.length / self.n, self.loads(x, v)
        free = np.vstack((np.zeros(3), load / mass, self.last(time)[2]))
        turning = -((u * u).sum(axis=1) - (e * u).sum(axis=1) ** 2) / length - (e * (free[1:] - free[:-1])).sum(axis=1)
        beside = (e[1:] * e[:-1]).sum(axis=1) / mass
        ends = np.concatenate(([1.0], np.full(self.n - 2, 2.0), [1.0])) / mass
        tension = np.linalg.solve(np.diag(beside, 1) + np.diag(beside, -1) - np.diag(ends), turning)
        pull = tension[:, None] * e
        return tension, (load + pull[1:] - pull[:-1]) / mass

    def whole(self, time, inner):
        """Positions [m] and velocities [m/s] of all nodes from those of the inner ones."""
        x, v, _ = self.last(time)
        inside = inner.reshape(2, -1, 3)
        return [np.vstack((np.zeros(3), part, end)) for part, end in zip(inside, (x, v), strict=True)]

    def at_rest(self):
        """Positions of the inner nodes in equilibrium [m]."""
        count, end = 3 * (self.n - 1), self.last(0.0)[0]
        start = sagging(end, self.length, self.n)

        def missing(unknown):
            x = np.vstack((start[:1], unknown[:count].reshape(-1, 3), end))
            load, _, e, length = self.loads(x, np.zeros_like(x))
            pull = unknown[count:, None] * e
            return np.concatenate(((load + pull[1:] - pull[:-1]).ravel(), length - self.length / self.n))

        found = root(missing, np.concatenate((start[1:-1].ravel(), np.full(self.n, 40.0))), method="hybr", tol=1e-13)
        assert np.abs(missing(found.x)).max() < 1e-9, found.message
        return found.x[:count]

    def motion(self, times):
        """Tensions of all segments [N] at times [s], array (times, segments)."""

        def rates(time, inner):
            x, v = self.whole(time, inner)
            return np.concatenate((v[1:-1].ravel(), self.tensions(time, x, v)[1].ravel()))

        start = np.concatenate((self.at_rest(), np.zeros(3 * (self.n - 1))))
        solved = solve_ivp(rates, (0.0, times[-1]), start, t_eval=times, **SOLVER)
        assert solved.success, solved.message
        rows = zip(times, solved.y.T, strict=True)
        return np.array([self.tensions(time, *self.whole(time, row))[0] for time, row in rows])


def inextensible_columns():
    """Columns of `inextensible.csv`: tension of the last segment of two chains whose last node sways."""
    times = 0.02 * np.arange(1, 201)
    short = Inextensible(5, 100.0, swaying(np.array([60.0, 0.0, 79.0])))
    long = Inextensible(20, 505.0, swaying(np.array([300.0, 0.0, 400.0])))
    return {"time": times, "tension_100m_n5": short.motion(times)[:, -1], "tension_505m_n20": long.motion(times)[:, -1]}


FILES = {f"tether_{number:02d}.csv": lambda number=number: tutorial_columns(number) for number in range(1, 9)}
FILES |= {"sceneB_n20_w0.1.csv": circle_columns, "wind_loaded.csv": wind_loaded_columns}
FILES |= {"inextensible.csv": inextensible_columns}
FROM = {"sceneB_n20_w0.1.csv": 2.0}  # time [s] from which a file is compared


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FILES)} (default: all)")
    parser.add_argument("--write", type=Path, metavar="DIR", help="folder for what is made")
    given = parser.parse_args()
    for name in given.names or FILES:
        made = FILES[name]()
        stored = np.genfromtxt(FOLDER / name, delimiter=",", names=True, deletechars="")
        rows = made["time"] >= FROM.get(name, 0.0) if "time" in made else slice(None)
        kinds = {}
        for column, values in made.items():
            kind = {"p": "position [m]", "v": "velocity [m/s]"}.get(column[0], "all else, relative")
            error = np.abs(values - stored[column])[rows]
            if kind == "all else, relative":
                error = error / np.abs(stored[column]).max()
            kinds[kind] = max(kinds.get(kind, 0.0), error.max())
        print(f"{name}: largest difference:", ", ".join(f"{kind} {error:.1e}" for kind, error in kinds.items()), flush=True)
        if given.write:
            given.write.mkdir(parents=True, exist_ok=True)
            table = np.column_stack(list(made.values()))
            np.savetxt(given.write / name, table, delimiter=",", header=",".join(made), comments="", fmt="%.17g")


if __name__ == "__main__":
    main()
