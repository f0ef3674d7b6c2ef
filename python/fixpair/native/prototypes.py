"""The prototypes of fixpair.h, a letter an argument."""

import ctypes

# What a letter of a signature stands for: p pointer, n size, d double, i int32, w uint32, u uint64.
LETTERS = {"p": ctypes.c_void_p, "n": ctypes.c_size_t, "d": ctypes.c_double, "i": ctypes.c_int32, "w": ctypes.c_uint32,
           "u": ctypes.c_uint64}

# Functions that return no status: their result and their arguments.
OTHERS = {
    "status_message": (ctypes.c_char_p, "i"), "version": (ctypes.c_char_p, ""), "threads_destroy": (None, "p"),
    "fft_next_side": (ctypes.c_size_t, "n"), "fft_padding_f32": (ctypes.c_size_t, "n"),
    "fft_padding_f64": (ctypes.c_size_t, "n"),
}

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
# Functions with a twin in either precision: name_f32 and name_f64.
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
