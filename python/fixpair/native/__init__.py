"""fixpair.h as ctypes sees it: every function, structure and constant under the name of the header, without its prefix.

Nothing here needs numpy. Pointers are addresses: integers, structures (passed by reference), or anything that has an
``__array_interface__``. A :class:`Library` raises the error of a status; the header says what each function asks for. The
layers above are for people, this one is for those who need a call as it is::

    from fixpair import native
    library = native.Library("libfixpair.so")
    brick = native.Brick()
    library.brick_whole(brick, 64, native.Space.FOURIER, 0)
"""

from .choices import (
    BISPECTRUM_WORDS, COLA_EXPONENT, Amplitude, Beta, Compensation, Convention, Difference, Event, Free, LinearSource,
    Moments, Multipole, Normalisation, Nyquist, Order, OverdensityDefinition, Phase, Ratio, Scheme, Second, Selection, Shape,
    Space, Spectrum, Status, Stepper, Window,
)
from .errors import (
    AlignmentError, BrickError, ChoiceError, ConvergenceError, FixpairError, HookError, LengthError, MeshSizeError,
    NotFiniteError, NullError, OutsideError, OverlapError, RangeError, SamplesError, ScratchError, SingularError, SizeError,
    Stopped, TableError, ThreadError, VersionError, error_of,
)
from .library import Library, address
from .prototypes import LETTERS, OTHERS, SIGNATURES, TWINS
from .structures import (
    Bias, BiasFit, BiasLikelihood, Bin, Binning, Body, Brick, Components, Conditions, ControlVariate, Cosmology,
    DifferenceOfMatched, Displacements, Epoch, Exec, Fft, ForceLaw, Gravity, Growth, Halo, HaloSums, Layout, Linear, Observe,
    Observer, Outputs, ParallelFor, Pass, Positions, Posterior, Progress, Realisation, ShapeRow, Species, Sphere, StepFactors,
    Structure, Sum, Suppression, SuppressionFit,
)

__all__ = [
    "AlignmentError", "Amplitude", "BISPECTRUM_WORDS", "Beta", "Bias", "BiasFit", "BiasLikelihood", "Bin", "Binning",
    "Body", "Brick", "BrickError", "COLA_EXPONENT", "ChoiceError", "Compensation", "Components", "Conditions",
    "ControlVariate", "Convention", "ConvergenceError", "Cosmology", "Difference", "DifferenceOfMatched", "Displacements",
    "Epoch", "Event", "Exec", "Fft", "FixpairError", "ForceLaw", "Free", "Gravity", "Growth", "Halo", "HaloSums",
    "HookError", "LETTERS", "Layout", "LengthError", "Library", "Linear", "LinearSource", "MeshSizeError", "Moments",
    "Multipole", "Normalisation", "NotFiniteError", "NullError", "Nyquist", "OTHERS", "Observe", "Observer", "Order",
    "Outputs", "OutsideError", "OverdensityDefinition", "OverlapError", "ParallelFor", "Pass", "Phase", "Positions",
    "Posterior", "Progress", "RangeError", "Ratio", "Realisation", "SIGNATURES", "SamplesError", "Scheme", "ScratchError",
    "Second", "Selection", "Shape", "ShapeRow", "SingularError", "SizeError", "Space", "Species", "Spectrum", "Sphere",
    "Status", "StepFactors", "Stepper", "Stopped", "Structure", "Sum", "Suppression", "SuppressionFit", "TWINS",
    "TableError", "ThreadError", "VersionError", "Window", "address", "error_of",
]
