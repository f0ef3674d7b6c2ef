"""Seconds that pySpectrum takes for all closed triangles of SHELLS shells of STEP k_f on an N^3 mesh, one thread.

    python pyspectrum_bispectrum.py N SHELLS STEP

Prints `counts seconds` (or `counts read` where pySpectrum ships the file for this geometry), `triangles number`,
`bispectrum seconds` (transforms of the shells and triangle sums; counts read from a file) and `peak_MiB` of the process.
N = 360, SHELLS = 40, STEP = 3 needs 16 GB and about ten minutes; its counts come with pySpectrum, which would need
N^3 * 16 bytes for each possible shell, 78 GB, to make them.

The mesh is white noise given in Fourier space: pySpectrum's deposit is not timed, nor its Fortran module called.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import resource
import sys
import tempfile
import time
import types

import numpy as np

try:
    import estimator  # noqa: F401  pySpectrum's Fortran part: deposit and P(k)
except ImportError:
    sys.modules["estimator"] = types.ModuleType("estimator")
from pyspectrum import pyspectrum


def main():
    n, shells, step = (int(a) for a in sys.argv[1:4])
    delta = np.fft.fftn(np.random.default_rng(1).standard_normal((n, n, n), np.float32)) / n**3
    delta = delta.astype(np.complex64)

    name = f"counts.Ngrid{n}.Nmax{shells}.Ncut{step}.step{step}.pyfftw"
    with tempfile.TemporaryDirectory() as folder:
        if os.path.isfile(os.path.join(pyspectrum.dat_dir(), name)):
            print("counts read", flush=True)
        else:
            pyspectrum.dat_dir = lambda: folder  # it saves the counts: not among its own files
            start = time.perf_counter()
            pyspectrum._counts_Bk123(Ngrid=n, Nmax=shells, Ncut=step, step=step)
            print(f"counts {time.perf_counter() - start:.3f}", flush=True)
        start = time.perf_counter()
        result = pyspectrum._Bk_periodic(delta, Nmax=shells, Ncut=step, step=step)
        seconds = time.perf_counter() - start
    print(f"triangles {len(result['b123'])}")
    print(f"bispectrum {seconds:.3f}")
    print(f"peak_MiB {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f}")


if __name__ == "__main__":
    main()
