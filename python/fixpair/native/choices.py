"""The constants of fixpair.h. ``FIXPAIR_WINDOW_CIC`` is ``Window.CIC``; the header says what each means."""

from enum import IntEnum, IntFlag


class Status(IntEnum):
    """What a function returns: 0, or what was wrong (``FIXPAIR_OK``, ``FIXPAIR_ERROR_...``)."""

    OK = 0
    NULL = -1
    LENGTH = -2
    ALIGNMENT = -3
    OVERLAP = -4
    NOT_FINITE = -5
    MESH_SIZE = -6
    BRICK = -7
    OVERFLOW = -8
    TABLE = -9
    RANGE = -10
    SCRATCH = -11
    HOOK = -12
    VERSION = -13
    CHOICE = -14
    THREAD = -15
    CONVERGENCE = -16
    OUTSIDE = -17
    STOPPED = -18
    SAMPLES = -19
    SINGULAR = -20


class Event(IntEnum):
    """What a run tells its observer: positions reached a step, or an output was written."""

    STEP = 0
    OUTPUT = 1


class Space(IntEnum):
    """Real cells, or complex modes of the half space l >= 0."""

    CONFIGURATION = 0
    FOURIER = 1


class Scheme(IntEnum):
    """How random modes are drawn: by mode number (native), or as N-GenIC and 2LPTic, or as FastPM draw them."""

    NATIVE = 0
    NGENIC = 1
    FASTPM = 2


class Amplitude(IntEnum):
    """Gaussian modes; |w| = 1, exactly the input power; or |w| = sqrt(pi)/2, the mean modulus."""

    NORMAL = 0
    FIXED = 1
    FIXED_TO_MEAN = 2


class Phase(IntEnum):
    """As drawn, or plus pi: the second member of a pair."""

    ORIGINAL = 0
    INVERTED = 1


class Nyquist(IntEnum):
    """Whether modes with a mode number n/2 are zero or modes like the others."""

    ZERO = 0
    FILLED = 1


class Selection(IntEnum):
    """Which modes are drawn: a cube or a sphere about k = 0."""

    CUBE = 0
    SPHERE = 1


class Convention(IntEnum):
    """f_NL of the potential in matter domination, or extrapolated linearly to z = 0."""

    CMB = 0
    LSS = 1


class LinearSource(IntEnum):
    """Rows of P(k) or T(k), or the fits of Eisenstein & Hu 1998 (``FIXPAIR_LINEAR_...``)."""

    POWER = 0
    TRANSFER = 1
    EISENSTEIN_HU = 2
    EISENSTEIN_HU_SMOOTH = 3


class Normalisation(IntEnum):
    """What ``amount`` of a linear spectrum is (``FIXPAIR_NORMALISE_...``)."""

    AS_GIVEN = 0
    SIGMA8 = 1
    AMPLITUDE = 2
    A_S = 3


class Ratio(IntEnum):
    """Which ratio of a species' columns."""

    MATTER = 0
    DENSITY = 1
    VELOCITY = 2


class Order(IntEnum):
    """Of Lagrangian perturbation theory."""

    FIRST = 1
    SECOND = 2
    THIRD = 3


class Shape(IntEnum):
    """Of primordial non-Gaussianity."""

    LOCAL = 0
    EQUILATERAL = 1
    ORTHOGONAL = 2
    ORTHOGONAL_LSS = 3
    FOLDED = 4
    ROWS = 5


class Window(IntEnum):
    """B-splines of 1 to 4 factors: nearest grid point, cloud in cell, triangular shaped cloud, piecewise cubic spline."""

    NGP = 1
    CIC = 2
    TSC = 3
    PCS = 4


class Difference(IntEnum):
    """Spectral derivatives, or differences of two or four neighbours."""

    EXACT = 0
    TWO_POINT = 1
    FOUR_POINT = 2


class Stepper(IntEnum):
    """How a run steps in time."""

    FASTPM = 0
    LEAPFROG = 1
    COLA = 2


class OverdensityDefinition(IntEnum):
    """Times the mean density, times the critical density, or virial (``FIXPAIR_OVERDENSITY_...``)."""

    MEAN = 0
    CRITICAL = 1
    VIRIAL = 2


class Second(IntEnum):
    """The second coordinate of bins: none, mu = |n.a|/|n|, or |n.a|."""

    NONE = 0
    COSINE = 1
    PARALLEL = 2


class Multipole(IntFlag):
    """Multipoles about the line of sight, to be combined: ``FIXPAIR_MULTIPOLE_0`` to ``_4``."""

    MONOPOLE = 1
    DIPOLE = 2
    QUADRUPOLE = 4
    OCTUPOLE = 8
    HEXADECAPOLE = 16


class Compensation(IntEnum):
    """What modes of a deposit are divided by: ``Compensation.ALIASED + Window.CIC`` and so on."""

    NONE = 0
    WINDOW = 16
    ALIASED = 32


class Moments(IntEnum):
    """What an ensemble keeps besides means."""

    VARIANCE = 0
    COVARIANCE = 1


class Spectrum(IntEnum):
    """P_hh = b^2 P_lin, or P_hm = b P_lin."""

    HALO_HALO = 0
    HALO_MATTER = 1


class Free(IntFlag):
    """Parameters of a bias that are fitted, to be combined."""

    B_G = 1
    P = 2
    F_NL = 4


class Beta(IntEnum):
    """The coefficient of a control variate: the caller's, or that of least scatter."""

    GIVEN = 0
    OPTIMAL = 1


COLA_EXPONENT = -2.5
"""The exponent n_LPT of COLA that its authors recommend."""

BISPECTRUM_WORDS = 42
"""64-bit integers in the sum of one triangle."""
