"""``python -m fixpair.demo``: Normal and Fixed, single and Paired, f_NL = 0 and 100 Matched, from seeds to figures."""

import argparse
import sys
import time
from pathlib import Path

from ..threads import Threads
from ..workspace import Workspace
from . import story
from .universes import Laboratory, measure_all


def arguments(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m fixpair.demo", description=__doc__.replace("``", ""))
    parser.add_argument("--size", type=int, default=64, help="particles and cells a side: even, 32 or more, factors 2, 3, 5, 7 (64)")
    parser.add_argument("--box", type=float, default=1000.0, help="side of the box in Mpc/h (1000)")
    parser.add_argument("--seeds", type=int, default=12, help="universes of each type, 3 or more (12)")
    parser.add_argument("--threads", type=int, default=2, help="threads; results do not depend on them (2)")
    parser.add_argument("--output", type=Path, default=Path("fixpair-demo"), help="folder of the figures (fixpair-demo)")
    options = parser.parse_args(words)
    if options.size < 32 or options.seeds < 3:
        parser.error("take --size 32 or more and --seeds 3 or more")
    return options


def progress(done: int, everything: int) -> None:
    """A line that fills, where somebody looks."""
    if sys.stderr.isatty():
        end = "\n" if done == everything else ""
        print(f"\r  {done} of {everything} universes", end=end, file=sys.stderr, flush=True)


def main(words: list[str]) -> None:
    options = arguments(words)
    try:
        from . import figures
    except ImportError as missing:
        sys.exit(f"{missing}: the figures need matplotlib, pip install 'fixpair[demo]'")
    options.output.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    print(f"{options.seeds} seeds, 8 universes each: {options.size}^3 particles in {options.box:g} Mpc/h, from z = 32 to z = 1")
    with Threads(options.threads), Workspace():
        laboratory = Laboratory(options.size, options.box)
        measured = measure_all(laboratory, range(1, options.seeds + 1), progress)
        results = story.tell(laboratory, measured)
        tracers = story.tracers(laboratory, measured, results["Fixed-Paired"])
    print(f"{time.monotonic() - began:.0f} s\n\n{story.table(laboratory, results)}\n")
    b_g, b_phi, error = tracers
    print(f"Tracers, cells of more than 1.5 times the mean: b_g = {b_g:.2f}, b_phi = {b_phi:.2f} +/- {error:.2f}")
    print("""
What follows +/- is the scatter of one estimate, of a simulation or of a pair. V_eff/V: how many Normal simulations one simulation is worth.
Fixing takes the scatter out of the power of matter until gravity brings it back; pairing takes out most of what is left on large scales.
Without f_NL the bispectrum of a pair cancels exactly, so that a pair matched is a pair alone: what scatters is the term of f_NL itself, unless the
amplitudes are fixed. Without pairs, the same seed with f_NL = 0 takes its place.""")
    for file in figures.draw(options.output, laboratory, measured, results, tracers):
        print(f"drawn: {file}")


if __name__ == "__main__":
    main(sys.argv[1:])
