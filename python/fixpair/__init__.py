"""Fixed, Paired and Matched initial conditions with primordial non-Gaussianity, from Python.

After Avila & Adame 2022 (arXiv:2204.11103). Rooms as in the library: :mod:`~fixpair.noise`, :mod:`~fixpair.cosmology`, :mod:`~fixpair.initial`,
:mod:`~fixpair.pm`, :mod:`~fixpair.halos`, :mod:`~fixpair.estimate`, :mod:`~fixpair.variance`. Units: lengths Mpc/h, wavenumbers h/Mpc, P(k)
(Mpc/h)^3, peculiar velocities km/s. Modes are normalised so that f(x) = sum_k f_k exp(+i k.x); then <|f_k|^2> = P(k)/L^3.

Rules that hold for every function:

* Arrays of numpy are used where they are, float32 or float64, never copied: one that the library cannot use as it is, is refused with TypeError or
  ValueError. What is changed in place is named first; what is only read may be a sequence where it is small.
* A mesh is an array (n, n, n) of reals, modes (n, n, n/2 + 1) of complex numbers, with any strides that go forwards. Parts of a mesh come with a
  :class:`Brick`.
* What the library refuses is a :class:`FixpairError`, by class and ``status``; outputs are then as they were unless it says otherwise.
* Kernels run on the threads of the :class:`Threads` block that they are called in, and work in its :class:`Workspace`. Results do not depend on
  either, bit for bit.
"""

from . import cosmology, estimate, fft, halos, initial, native, noise, pm, variance
from ._library import status_message, version
from .cosmology import Cosmology, Linear, Species
from .estimate import Binning, Sums, power_spectrum
from .fft import Fft, HostFft
from .initial import Conditions, initial_conditions, initial_conditions_at
from .mesh import Brick
from .native import (
    COLA_EXPONENT, AlignmentError, Amplitude, Beta, BrickError, ChoiceError, Compensation, Convention, ConvergenceError,
    Difference, Event, FixpairError, Free, HookError, LengthError, LinearSource, MeshSizeError, Moments, Multipole,
    Normalisation, NotFiniteError, NullError, Nyquist, Order, OutsideError, OverdensityDefinition, OverlapError, Phase,
    RangeError, Ratio, SamplesError, Scheme, ScratchError, Second, Selection, Shape, SingularError, SizeError, Space, Spectrum,
    Status, Stepper, Stopped, TableError, ThreadError, VersionError, Window,
)
from .noise import Realisation, white_modes
from .pm import ForceLaw, Gravity, deposit, evolve, read_out
from .threads import Threads
from .variance import Bias, Ensemble, Likelihood, Suppression
from .workspace import Workspace

__version__ = version()
__all__ = [
    "AlignmentError", "Amplitude", "Beta", "Bias", "Binning", "Brick", "BrickError", "COLA_EXPONENT", "ChoiceError",
    "Compensation", "Conditions", "Convention", "ConvergenceError", "Cosmology", "Difference", "Ensemble", "Event", "Fft",
    "FixpairError", "ForceLaw", "Free", "Gravity", "HookError", "HostFft", "LengthError", "Likelihood", "Linear",
    "LinearSource", "MeshSizeError", "Moments", "Multipole", "Normalisation", "NotFiniteError", "NullError", "Nyquist",
    "Order", "OutsideError", "OverdensityDefinition", "OverlapError", "Phase", "RangeError", "Ratio", "Realisation",
    "SamplesError", "Scheme", "ScratchError", "Second", "Selection", "Shape", "SingularError", "SizeError", "Space",
    "Species", "Spectrum", "Status", "Stepper", "Stopped", "Sums", "Suppression", "TableError", "ThreadError", "Threads",
    "VersionError", "Window", "Workspace", "__version__", "cosmology", "deposit", "estimate", "evolve", "fft", "halos",
    "initial", "initial_conditions", "initial_conditions_at", "native", "noise", "pm", "power_spectrum", "read_out",
    "status_message", "variance", "version", "white_modes",
]
