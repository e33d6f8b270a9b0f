"""What a communication step costs in Chromium against the native library, and how far the numbers are apart.

    python tests/benchmarks/browser.py

The circle of `examples/scenes` with 20 segments and steps of 20 ms, in wind: each tether flies 1000 steps in the page of
`tetherfmu web` and in the compiled loop of the Python API, by turns; the smallest time of each counts. Also the frames that
the page draws in a second. Needs Chromium with its driver.
"""

import tempfile
import time
from time import perf_counter

import numpy as np
from as_script import EXAMPLES

import chromium
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files import scene_files as files
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.start import tether_at_start

STEPS, STEP, ROUNDS, WIDTH = 1000, 0.02, 40, 1400
IN_THE_PAGE = """
const [name, rows, step] = arguments;
const { simulation } = tetherfmu;
tetherfmu.fly(false);
const { tether } = tetherfmu.simulation.flown.find(each => each.name === name);
const numbers = rows.map(each => Float64Array.from(each));
const view = tether.library.view(tether.inputs, numbers[0].length);
const began = performance.now();
for (const row of numbers) {
  view.set(row);
  tether.advance(step);
}
return [performance.now() - began, tether.vector("kite_force")];
"""


def native(variant, scene, rows):
    """Time of a step [us] and the last force on the kite [N] of the native library."""
    tether = tether_at_start(scene, variant=variant)
    began = perf_counter()
    tether.fly(rows, STEP, every=0)
    return 1e6 * (perf_counter() - began) / len(rows), tether.outputs().kite_force


def in_browser(browser, variant, rows):
    """The same in the page."""
    passed, force = browser.execute_script(IN_THE_PAGE, variant, rows.tolist(), STEP)
    return 1e3 * passed / len(rows), np.array(force)


def main():
    """Print the table."""
    scene = files.load(EXAMPLES / "scenes" / "circle.toml")
    rows = scene.inputs(STEP)[:STEPS]
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        began = perf_counter()
        tetherfmu(["web", "--out", folder])
        print(f"tetherfmu web: {perf_counter() - began:.1f} s in this process\n")
        with chromium.served(folder) as address, chromium.started(WIDTH, profile) as browser:
            browser.get(f"{address}/index.html#scene=circle&show=quasi_steady,dynamic")
            time.sleep(15.0)
            print(f"{browser.execute_script('return tetherfmu.fps'):.0f} frames a second: two tethers and the finer one\n")
            browser.get("about:blank")
            browser.get(f"{address}/index.html#scene=circle&show={','.join(VARIANTS)}")
            time.sleep(2.0)
            browser.execute_script("tetherfmu.run(false)")
            print("| tether | native | Chromium | ratio | deviation of the force |")
            print("|---|---|---|---|---|")
            for variant in VARIANTS:
                found = [(native(variant, scene, rows), in_browser(browser, variant, rows)) for _ in range(ROUNDS)]
                here, there = (min(each[k][0] for each in found) for k in (0, 1))
                (_, exact), (_, force) = found[-1]
                apart = np.abs(force - exact).max() / np.abs(exact).max()
                print(f"| {variant} | {here:.1f} µs | {there:.1f} µs | {there / here:.2f} | {apart:.1e} |")


if __name__ == "__main__":
    main()
