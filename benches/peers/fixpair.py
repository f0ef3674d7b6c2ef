"""fixpair's deposits, spectra, bispectra and statistics for numpy: what the checks need of fixpair.h, and nothing more.

    library = Library("target/release/libfixpair.so")
    mesh = library.mesh(n, np.float32)                        # (n, n, n + 2): rows are padded for a transform in place
    library.deposit(mesh, position, box, CIC)                 # or mesh[:, :, :n] = delta
    library.forward(mesh)                                     # the same memory holds modes now, times n^3
    bins, power = library.power([mesh], edges, box, orders=(0, 2, 4), compensation=[WINDOW + CIC])

Arrays go to the library where they lie. float32 takes its f32 functions, float64 its f64 functions. A refusal raises ValueError with the
library's message.
"""

import ctypes
import os
import sys

import numpy as np

NGP, CIC, TSC, PCS = 1, 2, 3, 4
WINDOW, ALIASED = 16, 32  # compensations: plus NGP, CIC, TSC or PCS; 0 is none
CONFIGURATION, FOURIER = 0, 1
BISPECTRUM_WORDS = 42

REAL = {np.dtype(np.float32): "f32", np.dtype(np.float64): "f64"}
BIN = np.dtype([("count", np.uint64), ("first", np.float64), ("second", np.float64)])

size, double, pointer = ctypes.c_size_t, ctypes.c_double, ctypes.c_void_p


class Brick(ctypes.Structure):
    _fields_ = [("n", size), ("space", ctypes.c_int32), ("start", size * 3), ("count", size * 3), ("stride", size * 3)]


class Layout(ctypes.Structure):
    _fields_ = [("size", size), ("align", size)]


class Positions(ctypes.Structure):
    _fields_ = [("x", pointer), ("y", pointer), ("z", pointer), ("stride", size), ("length", size)]


class Binning(ctypes.Structure):
    _fields_ = [("struct_size", size), ("edges", pointer), ("edges_len", size), ("second", ctypes.c_int32), ("orders", ctypes.c_uint32),
                ("second_edges", pointer), ("second_edges_len", size), ("axis", double * 3)]


Pass = ctypes.CFUNCTYPE(ctypes.c_int32, pointer, pointer)


class Fft(ctypes.Structure):
    _fields_ = [("struct_size", size), ("context", pointer), ("forward", Pass), ("inverse", Pass), ("sum", pointer),
                ("configuration", Brick), ("fourier", Brick), ("length", size)]


# Arguments, a letter each: p pointer, n size_t, d double, i int32_t, u uint64_t, w uint32_t.
LETTERS = {"p": pointer, "n": size, "d": double, "i": ctypes.c_int32, "u": ctypes.c_uint64, "w": ctypes.c_uint32}
SIGNATURES = {
    "brick_whole": "pnin", "edges_uniform": "pndd", "binning_init": "ppn", "binning_lengths": "ppppn", "binning_read": "pnpnpnpn",
    "binning_normalise": "pnpnwd", "power_sums_scratch": "pppn", "compensate_scratch": "pp", "correlation_modes_scratch": "pp", "correlation_sums_scratch": "pppn",
    "subtract_shot_noise": "pnpnpnwpn", "closed_triangle_count": "ppnp",
    "closed_triangles": "pnpnp", "triangle_counts_scratch": "ppnpnn", "triangle_counts": "ppnpnnpnp", "bispectrum_values": "pnpn",
    "bispectrum_normalise": "ppnndd", "bispectrum_shot_noise": "ppnpnd", "bispectrum_reduced": "pppnpn",
    "ensemble_length": "pni", "ensemble_init": "pnni", "ensemble_add": "pnpn", "ensemble_covariance": "pnnpnnn",
    "covariance_root_scratch": "pn", "covariance_root": "ppnpn", "matched_difference": "pppn", "delta_chi_squared": "pdw",
    "bias_init": "p", "likelihood_init": "p", "likelihood_add": "pppppni", "fit_bias": "pppw", "fit_suppression": "ppppppndu",
}
TWINS = {
    "fft_tables_scratch": "pn", "fft_tables_init": "pnn", "fft_scratch": "pn", "fft_init": "ppnnpnp", "deposit_scratch": "ppni",
    "deposit": "pnpppndidpnp", "power_sums": "pnpnnpnppppnp", "shot_noise": "ppnnd",
    "correlation_modes": "ppniidppnp", "correlation_sums": "pnpnnpppnp", "bispectrum_meshes": "ppn", "bispectrum_scratch": "ppnn", "bispectrum": "pnppnpnpnppnpnp", "compensate": "pnidppnp",
}
SIGNATURES |= {f"{name}_{real}": signature for name, signature in TWINS.items() for real in REAL.values()}


def address(argument):
    """What a pointer argument becomes: arrays and structures lend their memory."""
    if isinstance(argument, np.ndarray):
        return argument.ctypes.data
    if isinstance(argument, (ctypes.Structure, ctypes.Array, ctypes._SimpleCData)):
        return ctypes.addressof(argument)
    return argument


def aligned(count, dtype=np.uint8):
    """An array of zeros that begins on a cache line."""
    count *= np.dtype(dtype).itemsize
    memory = np.zeros(count + 63, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start:start + count].view(dtype)


def integers(values, dtype=np.uint64):
    return np.ascontiguousarray(values, dtype)


def bits(orders):
    return sum(1 << order for order in orders)


class Library:
    def __init__(self, path):
        if not os.path.isfile(path):
            sys.exit(f"{path} is not there; `cargo rustc --release --lib --crate-type cdylib` makes target/release/libfixpair.so")
        shared = ctypes.CDLL(os.path.abspath(path))
        self.functions = {name: getattr(shared, "fixpair_" + name) for name in SIGNATURES}
        for name, function in self.functions.items():
            function.restype, function.argtypes = ctypes.c_int32, [LETTERS[letter] for letter in SIGNATURES[name]]
        self.message = shared.fixpair_status_message
        self.message.restype, self.message.argtypes = ctypes.c_char_p, [ctypes.c_int32]
        self.transforms = {}

    def call(self, name, *arguments):
        status = self.functions[name](*map(address, arguments))
        if status != 0:
            raise ValueError(f"fixpair_{name}: {self.message(status).decode()}")

    def scratch(self, name, *arguments):
        """Scratch as the query of that name asks for, and its length."""
        layout = Layout()
        self.call(name, layout, *arguments)
        memory = aligned(layout.size)
        return memory, memory.size

    # -------------------------------------------------------------------------------------------- meshes and transforms

    def brick(self, n, space):
        brick = Brick()
        self.call("brick_whole", brick, n, space, 0)
        return brick

    def mesh(self, n, dtype):
        return aligned(n * n * (n + 2), dtype).reshape(n, n, n + 2)

    def modes(self, delta, dtype):
        """Modes of a cube, times n^3."""
        n = delta.shape[0]
        mesh = self.mesh(n, dtype)
        mesh[:, :, :n] = delta
        return self.forward(mesh)

    def transform(self, n, dtype):
        """The built-in transform; its tables and scratch stay with it."""
        key = n, np.dtype(dtype)
        if key not in self.transforms:
            real, fft = REAL[key[1]], Fft()
            tables = self.scratch(f"fft_tables_scratch_{real}", n)
            self.call(f"fft_tables_init_{real}", *tables, n)
            work = self.scratch(f"fft_scratch_{real}", n)
            self.call(f"fft_init_{real}", fft, *tables, 0, *work, None)
            self.transforms[key] = fft, tables, work
        return self.transforms[key][0]

    def forward(self, mesh):
        fft = self.transform(mesh.shape[0], mesh.dtype)
        assert fft.forward(fft.context, address(mesh)) == 0
        return mesh

    def deposit(self, mesh, position, box, window, weights=None, shift=0.0):
        """Adds particles, an array of triples with any strides, to a mesh."""
        n, real, each = mesh.shape[0], REAL[mesh.dtype], position.itemsize
        assert position.dtype == mesh.dtype and position.shape[1:] == (3,) and position.strides[0] % each == 0
        assert weights is None or (weights.dtype == mesh.dtype and len(weights) == len(position))
        x = position.ctypes.data
        triple = Positions(x, x + position.strides[1], x + 2 * position.strides[1], position.strides[0] // each, len(position))
        stride = 1 if weights is None else weights.strides[0] // each
        region = self.brick(n, CONFIGURATION)
        scratch = self.scratch(f"deposit_scratch_{real}", region, len(position), window)
        self.call(f"deposit_{real}", mesh, mesh.size, region, triple, weights, stride, box, window, shift, *scratch, None)
        return mesh

    # -------------------------------------------------------------------------------------------- power and correlation

    def edges_uniform(self, count, first, width):
        edges = np.empty(count, np.uint64)
        self.call("edges_uniform", edges, count, first, width)
        return edges

    def binning(self, edges, orders, axis, spectra):
        """A binning, its bins and values, and sums that are zero. It refers to `edges`, which the caller keeps."""
        binning, lengths = Binning(), (size(), size(), size())
        self.call("binning_init", binning, edges, len(edges))
        binning.orders = bits(orders)
        binning.axis[:] = [float(a == axis) for a in range(3)]
        self.call("binning_lengths", *lengths, binning, spectra)
        return binning, *(np.zeros(length.value, dtype) for length, dtype in zip(lengths, (BIN, np.float64, np.int64)))

    def multipoles(self, binning, bins, values, sums, orders, factor):
        """Bins, and values[spectrum, bin, order]."""
        spectra = values.size // (bins.size * len(orders))
        self.call("binning_read", bins, bins.size, values, values.size, sums, sums.size, binning, spectra)
        self.call("binning_normalise", values, values.size, bins, bins.size, binning.orders, factor)
        return bins, values.reshape(spectra, bins.size, len(orders))

    def power(self, fields, edges, box, orders=(0,), axis=2, pairs=((0, 0),), compensation=None):
        """Bins, and P_l[pair, bin, order] of modes that come from `forward`."""
        n, real, edges, pairs = fields[0].shape[0], REAL[fields[0].dtype], integers(edges), integers(pairs, np.uintp)
        brick = self.brick(n, FOURIER)
        binning, bins, values, sums = self.binning(edges, orders, axis, len(pairs))
        meshes = (pointer * len(fields))(*map(address, fields))
        compensation = None if compensation is None else integers(compensation, np.int32)
        scratch = self.scratch("power_sums_scratch", brick, binning, len(pairs))
        self.call(f"power_sums_{real}", sums, sums.size, meshes, len(fields), fields[0].size, pairs, len(pairs), compensation,
                  brick, binning, *scratch, None)
        return self.multipoles(binning, bins, values, sums, orders, box**3 / float(n) ** 6)

    def correlation(self, modes, compensation):
        """xi on the mesh, in the memory of modes that came from `forward`."""
        n, fft = modes.shape[0], self.transform(modes.shape[0], modes.dtype)
        brick = self.brick(n, FOURIER)
        scratch = self.scratch("correlation_modes_scratch", brick)
        self.call(f"correlation_modes_{REAL[modes.dtype]}", modes, None, modes.size, compensation, 0, float(n) ** -6, brick, *scratch, None)
        assert fft.inverse(fft.context, address(modes)) == 0
        return modes

    def correlation_multipoles(self, xi, edges, orders=(0,), axis=2):
        """Bins, and xi_l[0, bin, order]."""
        edges, brick = integers(edges), self.brick(xi.shape[0], CONFIGURATION)
        binning, bins, values, sums = self.binning(edges, orders, axis, 1)
        scratch = self.scratch("correlation_sums_scratch", brick, binning, 1)
        meshes = (pointer * 1)(address(xi))
        self.call(f"correlation_sums_{REAL[xi.dtype]}", sums, sums.size, meshes, 1, xi.size, brick, binning, *scratch, None)
        return self.multipoles(binning, bins, values, sums, orders, 1.0)

    def shot_noise(self, weights, particles, box):
        noise = double()
        real = "f64" if weights is None else REAL[weights.dtype]
        self.call(f"shot_noise_{real}", noise, weights, 0 if weights is None else 1, particles, box)
        return noise.value

    def subtract_shot_noise(self, power, bins, noise, orders=(0,)):
        """From the spectrum of one field, as `power` returns it."""
        pairs, noise = np.zeros((1, 2), np.uintp), np.array([noise])
        self.call("subtract_shot_noise", power, power.size, pairs, 1, bins, bins.size, bits(orders), noise, 1)
        return power

    def compensate(self, modes, compensation):
        """In place."""
        brick = self.transform(modes.shape[0], modes.dtype).fourier
        scratch = self.scratch("compensate_scratch", brick)
        self.call(f"compensate_{REAL[modes.dtype]}", modes, modes.size, compensation, 1.0, brick, *scratch, None)

    # ------------------------------------------------------------------------------------------------------- bispectrum

    def closed_triangles(self, edges, centres=None):
        edges, count = integers(edges), size()
        centres = None if centres is None else integers(centres, np.float64)
        self.call("closed_triangle_count", count, edges, len(edges), centres)
        triangles = np.empty((count.value, 3), np.uint32)
        self.call("closed_triangles", triangles, len(triangles), edges, len(edges), centres)
        return triangles

    def triangle_counts(self, triangles, edges, n):
        triangles, edges = integers(triangles, np.uint32), integers(edges)
        counts = np.empty(len(triangles), np.uint64)
        scratch = self.scratch("triangle_counts_scratch", triangles, len(triangles), edges, len(edges), n)
        self.call("triangle_counts", counts, triangles, len(triangles), edges, len(edges), n, *scratch, None)
        return counts

    def bispectrum_sums(self, modes, triangles, edges):
        """Integers, a row a triangle: rows add, and `bispectrum` makes numbers of them."""
        triangles, edges = integers(triangles, np.uint32), integers(edges)
        n, real, shells, reals = modes.shape[0], REAL[modes.dtype], len(edges) - 1, size()
        fft = self.transform(n, modes.dtype)
        self.call(f"bispectrum_meshes_{real}", reals, fft, max(shells, 3))
        fields = aligned(reals.value, modes.dtype)
        sums = np.zeros((len(triangles), BISPECTRUM_WORDS), np.int64)
        scratch = self.scratch(f"bispectrum_scratch_{real}", fft, shells, len(triangles))
        self.call(f"bispectrum_{real}", sums, sums.size, None, triangles, len(triangles), edges, len(edges), modes, modes.size, fft, fields,
                  fields.size, *scratch, None)
        return sums

    def bispectrum(self, sums, counts, n, box):
        """B of modes that came from `forward`."""
        sums, counts = integers(sums, np.int64), integers(counts)
        values = np.empty(len(sums))
        self.call("bispectrum_values", values, values.size, sums, sums.size)
        self.call("bispectrum_normalise", values, counts, len(sums), n, box, 1.0 / float(n) ** 3)
        return values

    def bispectrum_shot_noise(self, triangles, power, noise):
        triangles, power = integers(triangles, np.uint32), integers(power, np.float64)
        out = np.empty(len(triangles))
        self.call("bispectrum_shot_noise", out, triangles, len(triangles), power, len(power), noise)
        return out

    def reduced(self, bispectrum, triangles, power):
        triangles, power = integers(triangles, np.uint32), integers(power, np.float64)
        out = np.empty(len(triangles))
        self.call("bispectrum_reduced", out, bispectrum, triangles, len(triangles), power, len(power))
        return out
