"""fixpair.h for ctypes: the lower layer of the Python package, which needs the standard library alone, in the words of these tests."""

import importlib.util
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "python" / "fixpair" / "native"
# By its path: the package above it asks for numpy.
SPECIFICATION = importlib.util.spec_from_file_location("fixpair_native", FOLDER / "__init__.py",
                                                       submodule_search_locations=[str(FOLDER)])
native = sys.modules["fixpair_native"] = importlib.util.module_from_spec(SPECIFICATION)
SPECIFICATION.loader.exec_module(native)

from fixpair_native import *  # noqa: E402, F403
from fixpair_native import BiasLikelihood as Likelihood  # noqa: E402, F401
from fixpair_native import DifferenceOfMatched as Difference  # noqa: E402, F401
from fixpair_native import FixpairError as Refused  # noqa: E402, F401

for choices in (native.Space, native.Amplitude, native.Phase, native.Nyquist, native.Selection, native.Convention,
                native.LinearSource, native.Order, native.Shape, native.Window, native.Second, native.Moments,
                native.Spectrum):
    globals().update(choices.__members__)
NATIVE, NGENIC, FAST_PM = native.Scheme
AS_GIVEN, SIGMA8, AMPLITUDE, A_S = native.Normalisation
RATIO_MATTER, RATIO_DENSITY, RATIO_VELOCITY = native.Ratio
_, WINDOW, ALIASED = native.Compensation
EXACT, TWO_POINT, FOUR_POINT = native.Difference
FASTPM, LEAPFROG, COLA = native.Stepper
EVENT_STEP, EVENT_OUTPUT = native.Event
FREE_B_G, FREE_P, FREE_F_NL = native.Free
BETA_GIVEN, BETA_OPTIMAL = native.Beta
STOPPED, SAMPLES, SINGULAR = native.Status.STOPPED, native.Status.SAMPLES, native.Status.SINGULAR


class Library(native.Library):
    """`calls` keeps the last good call of each function."""

    def __init__(self, path):
        self.calls = {}
        super().__init__(path)

    def called(self, name, arguments):
        self.calls[name] = arguments
