"""fixpair.h for ctypes: structures, and functions that raise the library's message."""

import ctypes
import functools

c_double, c_float, c_int32, c_size_t, c_uint64, c_void_p = (
    ctypes.c_double, ctypes.c_float, ctypes.c_int32, ctypes.c_size_t, ctypes.c_uint64, ctypes.c_void_p)


def structure(name, **fields):
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})


Brick = structure("Brick", n=c_size_t, space=c_int32, start=c_size_t * 3, count=c_size_t * 3, stride=c_size_t * 3)
Layout = structure("Layout", size=c_size_t, align=c_size_t)
Body = ctypes.CFUNCTYPE(None, c_void_p, c_size_t)
ParallelFor = ctypes.CFUNCTYPE(c_int32, c_void_p, c_size_t, Body, c_void_p)
Exec = structure("Exec", context=c_void_p, parallel_for=ParallelFor)
# Data is passed as an address: both precisions have one type.
Pass = ctypes.CFUNCTYPE(c_int32, c_void_p, c_void_p)
Sum = ctypes.CFUNCTYPE(c_int32, c_void_p, ctypes.POINTER(c_double), c_size_t)
Fft = structure("Fft", struct_size=c_size_t, context=c_void_p, forward=Pass, inverse=Pass, sum=Sum,
                configuration=Brick, fourier=Brick, length=c_size_t)
Realisation = structure("Realisation", struct_size=c_size_t, seed=c_uint64, scheme=c_int32, amplitude=c_int32,
                        phase=c_int32, nyquist=c_int32, selection=c_int32, sample=ctypes.c_uint32)
Cosmology = structure("Cosmology", struct_size=c_size_t, omega_m=c_double, omega_de=c_double, omega_r=c_double,
                      omega_b=c_double, h=c_double, n_s=c_double, w0=c_double, wa=c_double, t_cmb=c_double)
Growth = structure("Growth", **dict.fromkeys("d f d2 f2 d3a f3a d3b f3b d3c f3c".split(), c_double))
Linear = structure("Linear", struct_size=c_size_t, source=c_int32, normalisation=c_int32, k=ctypes.POINTER(c_double),
                   value=ctypes.POINTER(c_double), rows=c_size_t, amount=c_double)
Conditions = structure("Conditions", struct_size=c_size_t, realisation=Realisation, cosmology=Cosmology, linear=Linear,
                       redshift=c_double, box_size=c_double, f_nl=c_double, g_nl=c_double, convention=c_int32,
                       order=c_int32, shape=c_int32, rows_len=c_size_t, rows=c_void_p, species=c_void_p)
ShapeRow = structure("ShapeRow", coefficient=c_double, s_out=c_double, s_a=c_double, s_b=c_double)
Species = structure("Species", struct_size=c_size_t, rows=c_size_t, k=c_void_p, matter=c_void_p, density=c_void_p,
                    velocity=c_void_p, reference=c_void_p)
Components = structure("Components", x=c_void_p, y=c_void_p, z=c_void_p, stride=c_size_t, length=c_size_t)
Positions = structure("Positions", x=c_void_p, y=c_void_p, z=c_void_p, stride=c_size_t, length=c_size_t)
Binning = structure("Binning", struct_size=c_size_t, edges=c_void_p, edges_len=c_size_t, second=c_int32,
                    orders=ctypes.c_uint32, second_edges=c_void_p, second_edges_len=c_size_t, axis=c_double * 3)
Bin = structure("Bin", count=c_uint64, first=c_double, second=c_double)
StepFactors = structure("StepFactors", factor=c_double, first=c_double, second=c_double)
ForceLaw = structure("ForceLaw", struct_size=c_size_t, laplacian=c_int32, gradient=c_int32, window=c_int32,
                     window_power=c_int32, split_scale=c_double)
Gravity = structure("Gravity", struct_size=c_size_t, cosmology=Cosmology, box_size=c_double, hubble=c_double, law=ForceLaw,
                    cola_exponent=c_double, stepper=c_int32, window=c_int32)
Epoch = structure("Epoch", position=c_double, velocity=c_double)
Displacements = structure("Displacements", first=Positions, second=Positions, scale_factor=c_double)
Outputs = structure("Outputs", scale_factors=c_void_p, length=c_size_t, position=Components, velocity=Components)
Progress = structure("Progress", event=c_int32, step=c_size_t, steps=c_size_t, output=c_size_t, epoch=Epoch)
Observe = ctypes.CFUNCTYPE(c_int32, c_void_p, ctypes.POINTER(Progress))
Observer = structure("Observer", context=c_void_p, observe=Observe)
Halo = structure("Halo", label=c_uint64, members=c_uint64, mass=c_double, centre=c_double * 3, velocity=c_double * 3,
                 radius=c_double, extent=c_double * 3, velocity_dispersion=c_double)
HaloSums = structure("HaloSums", label=c_uint64, members=c_uint64, reference=c_double * 3, reference_velocity=c_double * 3,
                     position=c_double * 3, position_squared=c_double, velocity=c_double * 3, velocity_squared=c_double,
                     low=c_double * 3, high=c_double * 3)
Sphere = structure("Sphere", members=c_uint64, mass=c_double, radius=c_double)
Suppression = structure("Suppression", cosmic_variance=c_double, softening=c_double, shot_noise=c_double)
SuppressionFit = structure("SuppressionFit", value=Suppression, error=Suppression, covariance=c_double * 9,
                           chi_squared=c_double, degrees=c_uint64)
Bias = structure("Bias", b_g=c_double, p=c_double, f_nl=c_double, delta_c=c_double)
Likelihood = structure("Likelihood", bins=c_uint64, root=c_double * 36)
BiasFit = structure("BiasFit", value=Bias, error=c_double * 3, covariance=c_double * 9, chi_squared=c_double, degrees=c_uint64)
Posterior = structure("Posterior", peak=c_double, mean=c_double, deviation=c_double, low=c_double, high=c_double,
                      centre=c_double, half_width=c_double, edge=c_double)
Difference = structure("Difference", mean_first=c_double, mean_second=c_double, deviation_first=c_double,
                       deviation_second=c_double, correlation=c_double, correlation_error=c_double, mean=c_double,
                       deviation=c_double, error_of_mean=c_double)
ControlVariate = structure("ControlVariate", mean=c_double, error=c_double, beta=c_double, correlation=c_double,
                           deviation=c_double, gain=c_double)

CONFIGURATION, FOURIER = 0, 1
NORMAL, FIXED, FIXED_TO_MEAN = 0, 1, 2
ORIGINAL, INVERTED = 0, 1
ZERO, FILLED = 0, 1
NATIVE, NGENIC, FAST_PM = 0, 1, 2
CUBE, SPHERE = 0, 1
CMB, LSS = 0, 1
POWER, TRANSFER, EISENSTEIN_HU, EISENSTEIN_HU_SMOOTH = 0, 1, 2, 3
AS_GIVEN, SIGMA8, AMPLITUDE, A_S = 0, 1, 2, 3
FIRST, SECOND, THIRD = 1, 2, 3
LOCAL, EQUILATERAL, ORTHOGONAL, ORTHOGONAL_LSS, FOLDED, ROWS = 0, 1, 2, 3, 4, 5
RATIO_MATTER, RATIO_DENSITY, RATIO_VELOCITY = 0, 1, 2
NGP, CIC, TSC, PCS = 1, 2, 3, 4
COSINE, PARALLEL = 1, 2
WINDOW, ALIASED = 16, 32
BISPECTRUM_WORDS = 42
EXACT, TWO_POINT, FOUR_POINT = 0, 1, 2
FASTPM, LEAPFROG, COLA = 0, 1, 2
COLA_EXPONENT = -2.5
EVENT_STEP, EVENT_OUTPUT = 0, 1
STOPPED, SAMPLES, SINGULAR = -18, -19, -20
VARIANCE, COVARIANCE = 0, 1
HALO_HALO, HALO_MATTER = 0, 1
FREE_B_G, FREE_P, FREE_F_NL = 1, 2, 4
BETA_GIVEN, BETA_OPTIMAL = 0, 1

# What a letter of a signature stands for: p pointer, n size, d double, i int32, w uint32, u uint64.
LETTERS = {"p": c_void_p, "n": c_size_t, "d": c_double, "i": c_int32, "w": ctypes.c_uint32, "u": c_uint64}

SIGNATURES = {
    "brick_whole": "pnin", "brick_slab": "pninn", "brick_transposed_slab": "pnnn", "brick_reals": "pp",
    "exec_self_test": "p", "threads_create": "ppn",
    "realisation_init": "pu", "philox4x32_10": "ppp", "ranlxd1": "pnu", "ngenic_seeds": "pnpu",
    "cosmology_init": "p", "radiation_density": "pddd", "expansion": "ppnp", "growth_factors": "ppnp",
    "growth_suppression": "pp", "linear_power": "ppnppd", "linear_transfer": "ppnpp", "linear_sigma": "pdpp",
    "alpha": "ppnppdi", "mode_table_length": "pn", "potential_amplitude_table": "pnndppip",
    "alpha_table": "pnndppdip", "species_init": "p", "species_table": "pnpindp", "conditions_init": "pu", "shape_rows": "pnpi",
    "particle_ids": "pnpup", "brick_with_ghosts": "ppid",
    "binning_init": "ppn", "binning_lengths": "ppppn", "binning_read": "pnpnpnpn", "binning_normalise": "pnpnwd",
    "edges_uniform": "pndd", "edges_wavenumbers": "ppnd", "edges_exact": "pnu", "power_sums_scratch": "pppn",
    "subtract_shot_noise": "pnpnpnwpn", "correlation_modes_scratch": "pp", "correlation_sums_scratch": "pppn",
    "compensate_scratch": "pp",
    "closed_triangle_count": "ppnp", "closed_triangles": "pnpnp", "squeezed_triangles": "pnnn",
    "triangle_counts_scratch": "ppnpnn", "triangle_counts": "ppnpnnpnp", "bispectrum_values": "pnpn",
    "force_law_init": "p", "force_scratch": "pn", "gravity_init": "p", "drift_factors": "ppidddd", "kick_factors": "ppidddd",
    "linear_steps": "pndd", "logarithmic_steps": "pndd", "linking_length": "pddu", "particle_mass": "pddu",
    "overdensity": "pidpd", "fof_merge": "pnppn", "fof_relabel": "pnpnp", "halos_scratch": "pn", "halo_sums_merge": "pnpd",
    "halo_count": "ppnupnp", "halos_finish": "pnppndud",
    "ensemble_length": "pni", "ensemble_init": "pnni", "ensemble_add": "pnpn", "ensemble_merge": "pnp", "ensemble_count": "ppn",
    "ensemble_mean": "pnpn", "ensemble_deviation": "pnpn", "ensemble_error_of_mean": "pnpn",
    "ensemble_covariance": "pnnpnnn", "ensemble_correlation": "pnnpnnn", "pair_average": "pppn",
    "sigma_per_simulation": "pppnuu", "bootstrap_indices": "pnuuu", "resampled_mean": "pnpnpn", "jackknife_means": "ppnn",
    "jackknife": "pppnpn", "jackknife_covariance": "ppnn", "continuum_modes": "ppndd", "lattice_modes": "ppn",
    "sigma_gaussian": "pppnd", "sigma_suppressed": "pppppnd", "fit_suppression": "ppppppndu",
    "ratio_of_means": "pppppppn", "difference_of_means": "ppppppppn", "bias_init": "p", "bias_of_k": "pppn",
    "halo_power": "ppppni", "measured_bias": "pppppni", "likelihood_init": "p", "likelihood_add": "pppppni",
    "likelihood_add_correlated_scratch": "pn", "likelihood_add_correlated": "pppppnndpn", "likelihood_merge": "pp",
    "likelihood_chi_squared": "ppp", "fit_bias": "pppw", "bias_posterior_scratch": "pn", "bias_posterior": "ppnppwndpn",
    "bias_range": "pnppw", "bias_grid": "pnppwppn", "marginal": "ppnnidd", "read_posterior": "ppnddd",
    "contours": "pnppnnpd", "delta_chi_squared": "pdw", "hartlap_factor": "puu", "percival_factor": "puuu",
    "matched_difference": "pppn", "difference_sigma": "pddd", "effective_volume": "pdudu", "universality": "ppdddddd",
    "control_variates_scratch": "pn", "control_variates": "pnppnppidpn", "control_variate_gain": "pdddd",
    "control_variate_loss": "puu", "covariance_root_scratch": "pn", "covariance_root": "ppnpn", "carpool_scratch": "pnn",
    "carpool": "pppppnnppnpn",
    "bispectrum_normalise": "ppnndd", "bispectrum_shot_noise": "ppnpnd", "bispectrum_reduced": "pppnpn",
}
TWINS = {
    "fft_tables_scratch": "pn", "fft_tables_init": "pnn", "fft_scratch": "pn", "fft_init": "ppnnpnp",
    "fft_self_test": "ppn", "white_modes": "pnpppnp", "impose": "pnppp", "modes_from_field": "pnppp",
    "initial_conditions_scratch": "pppp", "initial_conditions": "ppppppnp", "initial_conditions_at_scratch": "ppnpp",
    "initial_conditions_at": "pppppppnp", "third_order_sources_scratch": "pp", "third_order_sources": "pppppppnppnp",
    "transverse_displacement": "pnpppnndpp", "scale_modes": "pnppnp",
    "copy_modes": "pnppnpp", "add_local_scratch": "pp", "add_local": "pnpddppnpnp",
    "add_shape_scratch": "ppp", "add_shape": "pnpddpnppnp",
    "second_order_source": "pnpnpppppnp", "displacement": "pnpnpndpp", "displace": "ppppnpndddp",
    "deposit_scratch": "ppni", "deposit": "pnpppndidpnp", "read_out_scratch": "ppni", "read_out": "pnpnppdidpnp",
    "add_cells": "pnppnpp", "copy_cells": "pnppnpp", "interlace": "ppnpp", "power_sums": "pnpnnpnppppnp",
    "shot_noise": "ppnnd", "correlation_modes": "ppniidppnp", "correlation_sums": "pnpnnpppnp",
    "compensate": "pnidppnp",
    "shell_modes": "ppnpuup", "bispectrum_sums_scratch": "ppnn", "bispectrum_sums": "pnpnpnnppnp",
    "forces": "pppnppddpnp", "force": "ppnpnpddpnp", "potential": "pnppddpnp", "kick_scratch": "ppni",
    "kick": "pppppnpdidddddpppnp", "drift": "ppddddppp", "evolve_scratch": "ppni", "evolve": "ppppppnppppnppnpp",
    "fof_labels_scratch": "pn", "fof_labels": "pnppnddpnp", "halos": "pnppnppdudpnp", "halo_sums": "pnppnppdupnpnp",
    "spheres_scratch": "pn", "spheres": "pnpnpnpdudupnp", "refine_centres": "pnppddupnp",
    "bispectrum_meshes": "ppn", "bispectrum_scratch": "ppnn", "bispectrum": "pnppnpnpnppnpnp",
}
SIGNATURES.update({f"{name}_{real}": signature for name, signature in TWINS.items() for real in ("f32", "f64")})


class Refused(Exception):
    """A negative status and its message."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


def address(argument):
    """What a pointer argument becomes: structures and arrays are passed by reference."""
    if isinstance(argument, (ctypes.Structure, ctypes.Array, ctypes._SimpleCData)):
        return ctypes.addressof(argument)
    return argument


class Library:
    """The functions of the shared library, without their prefix. `calls` keeps the last good call of each."""

    def __init__(self, path):
        self.shared = ctypes.CDLL(path)
        self.calls = {}
        others = {
            "status_message": (ctypes.c_char_p, [c_int32]), "version": (ctypes.c_char_p, []),
            "threads_destroy": (None, [c_void_p]), "fft_next_side": (c_size_t, [c_size_t]),
            "fft_padding_f32": (c_size_t, [c_size_t]), "fft_padding_f64": (c_size_t, [c_size_t]),
        }
        for name, (result, arguments) in others.items():
            function = getattr(self.shared, "fixpair_" + name)
            function.restype, function.argtypes = result, arguments
            setattr(self, name, functools.partial(self.noted, name, function))
        for name, signature in SIGNATURES.items():
            function = getattr(self.shared, "fixpair_" + name)
            function.restype, function.argtypes = c_int32, [LETTERS[letter] for letter in signature]
            setattr(self, name, functools.partial(self.checked, name, function))

    def noted(self, name, function, *arguments):
        self.calls[name] = arguments
        return function(*arguments)

    def checked(self, name, function, *arguments):
        status = function(*map(address, arguments))
        if status != 0:
            raise Refused(status, self.status_message(status).decode())
        self.calls[name] = arguments
