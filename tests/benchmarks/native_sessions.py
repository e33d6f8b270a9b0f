"""Many random sessions of calls on the shell of native FMUs under sanitizers, see `tests/native/driver.c`.

    python tests/benchmarks/native_sessions.py [--sessions 100000]

So many in all, over each variant for FMI 2 and 3. Needs gcc and 64-bit Linux.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from as_script import options

from native import programs
from tetherfmu.runtime.variants import EVERY_VARIANT


def main(sessions):
    """Print what each program says; returns how many of them failed."""
    runs, failed = [(variant, fmi) for variant in EVERY_VARIANT for fmi in (2, 3)], 0
    for seed, (variant, fmi) in enumerate(runs):
        with tempfile.TemporaryDirectory() as folder:
            driver = Path(programs.__file__).with_name("driver.c")
            program = programs.compiled(Path(folder), variant, fmi, driver, programs.SANITIZED)
            command = [program, str(seed), str(-(-sessions // len(runs)))]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        failed += done.returncode != 0
        print(f"{variant}, FMI {fmi}: {done.stdout.strip() or done.stderr}", flush=True)
    return failed


if __name__ == "__main__":
    sys.exit(main(options(__doc__, sessions=100_000).sessions))
