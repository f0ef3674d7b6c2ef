"""What 05_matched_fnl.c does, in Python through the shared library: from P(k) of halos in matched simulations to f_NL.

    python3 05_matched_fnl.py [options] TABLE...      --help

Standard library only. Arrays are those of ctypes; `(Double * a.size).from_buffer(a)` shares the memory of a numpy array of doubles in C
order, and `a.ctypes.data` will do for a function of the library itself. The numbers are those of the C program, to the last digit.
"""

import argparse
import csv
import ctypes
import math
import pathlib
import sys
from ctypes import byref
from types import SimpleNamespace

# ---- The part of fixpair.h that is used here.

def structure(name, **fields):
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})


Double, Int, Size, Long, Pointer = ctypes.c_double, ctypes.c_int32, ctypes.c_size_t, ctypes.c_uint64, ctypes.c_void_p
Layout = structure("Layout", size=Size, align=Size)
Cosmology = structure("Cosmology", struct_size=Size, omega_m=Double, omega_de=Double, omega_r=Double, omega_b=Double, h=Double,
                      n_s=Double, w0=Double, wa=Double, t_cmb=Double)
Linear = structure("Linear", struct_size=Size, source=Int, normalisation=Int, k=Pointer, value=Pointer, rows=Size, amount=Double)
Suppression = structure("Suppression", cosmic_variance=Double, softening=Double, shot_noise=Double)
SuppressionFit = structure("SuppressionFit", value=Suppression, error=Suppression, covariance=Double * 9, chi_squared=Double, degrees=Long)
Bias = structure("Bias", b_g=Double, p=Double, f_nl=Double, delta_c=Double)
Likelihood = structure("Likelihood", bins=Long, root=Double * 36)
BiasFit = structure("BiasFit", value=Bias, error=Double * 3, covariance=Double * 9, chi_squared=Double, degrees=Long)
Posterior = structure("Posterior", peak=Double, mean=Double, deviation=Double, low=Double, high=Double, centre=Double, half_width=Double,
                      edge=Double)
Difference = structure("Difference", mean_first=Double, mean_second=Double, deviation_first=Double, deviation_second=Double,
                       correlation=Double, correlation_error=Double, mean=Double, deviation=Double, error_of_mean=Double)
ControlVariate = structure("ControlVariate", mean=Double, error=Double, beta=Double, correlation=Double, deviation=Double, gain=Double)

MOMENTS_VARIANCE, HALO_HALO, FREE_B_G, FREE_F_NL, BETA_OPTIMAL, POWER, TRANSFER, AS_GIVEN, SIGMA8 = 0, 0, 1, 4, 1, 0, 1, 0, 1

# Arguments: p pointer, n size_t, u uint64_t, i int32_t and uint32_t, d double.
SIGNATURES = {
    "cosmology_init": "p", "linear_power": "ppnppd", "alpha": "ppnppdi",
    "ensemble_length": "pni", "ensemble_init": "pnni", "ensemble_add": "pnpn", "ensemble_mean": "pnpn", "ensemble_deviation": "pnpn",
    "pair_average": "pppn", "sigma_per_simulation": "pppnuu", "sigma_gaussian": "pppnd", "sigma_suppressed": "pppppnd",
    "fit_suppression": "ppppppndu", "bias_init": "p", "likelihood_init": "p", "likelihood_add": "pppppni", "bias_posterior_scratch": "pn",
    "bias_posterior": "ppnppindpn", "bootstrap_indices": "pnuuu", "matched_difference": "pppn", "difference_sigma": "pddd", "effective_volume": "pdudu",
    "universality": "ppdddddd", "control_variates_scratch": "pn", "control_variates": "pnppnppidpn", "control_variate_gain": "pdddd",
}


class Library:
    """fixpair_NAME as .NAME; what is refused raises the library's sentence about it."""

    def __init__(self, path):
        loaded = ctypes.CDLL(str(path))
        loaded.fixpair_status_message.restype = ctypes.c_char_p
        kinds = {"p": Pointer, "n": Size, "u": Long, "i": Int, "d": Double}
        for name, letters in SIGNATURES.items():
            function = getattr(loaded, "fixpair_" + name)
            function.argtypes, function.restype = [kinds[letter] for letter in letters], Int
            setattr(self, name, self.checked(name, function, loaded.fixpair_status_message))

    @staticmethod
    def checked(name, function, message):
        def call(*arguments):
            status = function(*arguments)
            if status < 0:
                raise ValueError(f"fixpair_{name}: {message(status).decode()}")
        return call


def doubles(values):
    """An array of doubles: a copy of `values`, or so many zeros."""
    return (Double * values)() if isinstance(values, int) else (Double * len(values))(*values)


def row(array, number, length):
    """A pointer to a row of an array of rows."""
    return byref(array, 8 * number * length)


def memory(layout):
    """Memory as a ..._scratch function asks for it; keep the first as long as the second, an address, is in use."""
    block = ctypes.create_string_buffer(layout.size + layout.align)
    return block, -(-ctypes.addressof(block) // layout.align) * layout.align


# ---- Files. What is said of them in common/matched.h and common/boltzmann.h holds here.

NAMES = ("seed", "amplitude", "phase", "f_NL", "k [h/Mpc]", "modes", "linear P [(Mpc/h)^3]", "P of halos less shot noise [(Mpc/h)^3]",
         "halos")


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        for name in NAMES:
            if name not in (reader.fieldnames or ()):
                sys.exit(f'{path}:1: there is no column "{name}"; this line must name it')
        for line in reader:
            seed, amplitude, phase, *numbers = (line[name] for name in NAMES)
            f_nl, *numbers = map(float, numbers)
            yield (amplitude, phase, f_nl, int(seed)), numbers


def read_matched(paths, box):
    """Spectra by (amplitude, phase, half): a row a seed, all in one array."""
    simulations = {}
    for path in paths:
        for key, numbers in read_rows(path):
            simulations.setdefault(key, []).append(numbers)
    types = sorted({key[:2] for key in simulations})
    seeds = sorted({key[3] for key in simulations})
    f_nl = sorted({key[2] for key in simulations}, key=abs)
    if len(f_nl) != 2 or f_nl[0] != 0.0:
        sys.exit(f"f_NL of {f_nl}: matched simulations are those of the same seed at 0 and one other")
    if len(seeds) < 8:
        sys.exit(f"{len(seeds)} seeds are too few for a scatter; run 8 at least")
    power, halos, bins = {}, [0.0, 0.0], None
    for amplitude, phase in types:
        for half in range(2):
            rows = []
            for seed in seeds:
                key = (amplitude, phase, f_nl[half], seed)
                if key not in simulations:
                    sys.exit(f"seed {seed}, {amplitude} {phase}, f_NL = {f_nl[half]:g}: missing. Matching needs every seed at both f_NL "
                             "and in every type: add it, or take the seed out")
                columns = list(zip(*sorted(simulations[key])))
                bins = bins or columns[:3]
                if bins != columns[:3] or any(k >= after for k, after in zip(bins[0], bins[0][1:])):
                    sys.exit(f"seed {seed}, {amplitude} {phase}, f_NL = {f_nl[half]:g}: other bins than other simulations, or twice in "
                             "the table")
                rows += columns[3]
                halos[half] += columns[4][0]
            power[amplitude, phase, half] = doubles(rows)
    k, modes, linear = map(doubles, bins)
    halos = [total / (len(types) * len(seeds)) for total in halos]
    # Modes up to the last bin fill a sphere of the box's own grid: N = V k^3/(6 pi^2).
    half_width = 0.5 * (k[-1] - k[0]) / (len(k) - 1)
    volume = sum(modes) * 6.0 * math.pi ** 2 / ((k[-1] + half_width) ** 3 - (k[0] - half_width) ** 3)
    if abs(volume / box ** 3 - 1.0) >= 0.25:
        sys.exit(f"k and modes are those of a box of {volume ** (1.0 / 3.0):.0f} Mpc/h, not of {box:g}: say --box. (Modes count k and -k.)")
    return SimpleNamespace(box=box, seeds=seeds, bins=len(k), f_nl=f_nl, k=k, modes=modes, linear=linear, halos=halos, power=power)


def read_linear(path):
    """The spectrum of a Boltzmann code, and the arrays that it points to."""
    with open(path, encoding="utf-8") as file:
        rows = [line.split() for line in (text.split("#")[0] for text in file) if line.strip()]
    column = {2: 1, 5: 2, 7: 6, 13: 6}.get(len(rows[0]))
    if column is None:
        sys.exit(f"{path}: neither 2, 5, 7 nor 13 columns: no format that is known here")
    k, value = doubles([float(cells[0]) for cells in rows]), doubles([float(cells[column]) for cells in rows])
    source, normalisation = (POWER, AS_GIVEN) if column < 3 else (TRANSFER, SIGMA8)
    linear = Linear(ctypes.sizeof(Linear), source, normalisation, ctypes.addressof(k), ctypes.addressof(value), len(k), 0.8)
    return linear, (k, value)


# ---- From spectra to constraints: common/constraints.c, function by function.

NORMAL, FIXED, FIXED_PAIRED, NORMAL_PAIRED = "Normal", "Fixed", "Fixed-Paired", "Normal-Paired"
TYPES, FITTED = (NORMAL, FIXED, FIXED_PAIRED, NORMAL_PAIRED), (NORMAL, FIXED, FIXED_PAIRED)
POINTS, PROBABILITY, REPLICATES, BOOTSTRAP_SEED = 128, 0.68, 1000, 1


class Analysis:
    def __init__(self, library, matched, choice, linear):
        self.fixpair, self.matched, self.choice = library, matched, choice
        cosmology = Cosmology()
        library.cosmology_init(byref(cosmology))
        if choice.omega_m is not None:
            cosmology.omega_m, cosmology.omega_de = choice.omega_m, 1.0 - choice.omega_m
        if choice.n_s is not None:
            cosmology.n_s = choice.n_s
        self.scatter_bins = sum(k < choice.k_scatter for k in matched.k)
        self.bias_bins = sum(k <= choice.k_bias for k in matched.k)
        if self.scatter_bins < 4 or self.bias_bins < 3:
            sys.exit(f"{self.scatter_bins} bins for the scatter and {self.bias_bins} for f_NL are too few; 4 and 3 at least")
        last = self.bias_bins - 1
        power = Double()
        library.linear_power(byref(power), byref(matched.k, 8 * last), 1, byref(cosmology), byref(linear), choice.redshift)
        if abs(matched.linear[last] / power.value - 1.0) >= 0.05:
            sys.exit(f"linear P is {matched.linear[last]:g} (Mpc/h)^3 at k = {matched.k[last]:g} h/Mpc, where that of the Boltzmann code's "
                     f"table is {power.value:g} at z = {choice.redshift:g}: say --redshift, --linear, --omega-m or --n-s")
        self.alpha = doubles(matched.bins)
        library.alpha(self.alpha, matched.k, matched.bins, byref(cosmology), byref(linear), choice.redshift, int(choice.lss))
        self.types = {}
        for name in TYPES:
            paired = name in (FIXED_PAIRED, NORMAL_PAIRED)
            amplitude = "normal" if name in (NORMAL, NORMAL_PAIRED) else "fixed"
            if (amplitude, "original", 0) not in matched.power or (paired and (amplitude, "inverted", 0) not in matched.power):
                continue
            found = self.types[name] = SimpleNamespace(name=name, amplitude=amplitude, simulations=2 if paired else 1)
            found.half = [self.measure(found, half) for half in range(2)]
            if name in FITTED:
                for half in found.half:
                    self.fit_half(half)
                self.match(found)
                self.compare(found)

    def moments(self, samples, values):
        """Mean and standard deviation of each value over the rows of one or more arrays; the deviation over those of the first."""
        length = Size()
        self.fixpair.ensemble_length(byref(length), values, MOMENTS_VARIANCE)
        state, mean, deviation = doubles(length.value), doubles(values), doubles(values)
        self.fixpair.ensemble_init(state, length, values, MOMENTS_VARIANCE)
        for number, array in enumerate(samples):
            self.fixpair.ensemble_add(state, length, array, len(array))
            if number == 0:
                self.fixpair.ensemble_deviation(deviation, values, state, length)
        self.fixpair.ensemble_mean(mean, values, state, length)
        return mean, deviation

    def measure(self, found, number):
        """Mean, scatter and its fit, of one type and half."""
        fixpair, matched, bins, seeds = self.fixpair, self.matched, self.matched.bins, len(self.matched.seeds)
        phases = [matched.power[key] for phase in ("original", "inverted") if (key := (found.amplitude, phase, number)) in matched.power]
        noise = matched.box * matched.box * matched.box / matched.halos[number]
        half = SimpleNamespace(samples=phases[0], sigma=doubles(bins), error=doubles(bins), theory=doubles(bins), fit=None, f_nl=None)
        if found.simulations == 2:
            half.samples = doubles(seeds * bins)
            fixpair.pair_average(half.samples, *phases, seeds * bins)
        _, half.used = self.moments([half.samples], bins)
        fixpair.sigma_per_simulation(half.sigma, half.error, half.used, bins, seeds, found.simulations)
        half.mean, _ = self.moments(phases, bins)
        fixpair.sigma_gaussian(half.theory, half.mean, matched.modes, bins, noise)
        if self.choice.measured or found.name == NORMAL_PAIRED:
            return half
        if found.name == NORMAL:
            half.used = half.theory
            return half
        half.fit = SuppressionFit()
        try:
            fixpair.fit_suppression(byref(half.fit), half.sigma, None, matched.k, half.mean, matched.modes, self.scatter_bins, noise, seeds)
            fixpair.sigma_suppressed(half.used, byref(half.fit.value), matched.k, half.mean, matched.modes, bins, noise)
        except ValueError as error:
            sys.exit(f"{error}; the scatter of the {found.name} simulations is not that of Eq. sigma_fix: fit f_NL with what was measured, "
                     "--measured")
        half.used = doubles([sigma / math.sqrt(found.simulations) for sigma in half.used])
        return half

    def fit(self, power, sigma):
        """Posteriors of b_g and f_NL for one spectrum: case (iii), p = 1."""
        likelihood, start, fit, posteriors, layout = Likelihood(), Bias(), BiasFit(), (Posterior * 2)(), Layout()
        self.fixpair.likelihood_init(byref(likelihood))
        self.fixpair.likelihood_add(byref(likelihood), power, sigma, self.matched.linear, self.alpha, self.bias_bins, HALO_HALO)
        self.fixpair.bias_init(byref(start))
        self.fixpair.bias_posterior_scratch(byref(layout), POINTS)
        block, scratch = memory(layout)
        self.fixpair.bias_posterior(byref(fit), posteriors, 2, byref(likelihood), byref(start), FREE_B_G | FREE_F_NL, POINTS, PROBABILITY,
                                    scratch, layout.size)
        del block
        return posteriors

    def fit_half(self, half):
        fits = [self.fit(row(half.samples, seed, self.matched.bins), half.used) for seed in range(len(self.matched.seeds))]
        half.b_g, half.f_nl = (doubles([fit[parameter].peak for fit in fits]) for parameter in range(2))
        half.on_mean = self.fit(half.mean, half.used)[1]

    def match(self, found):
        fixpair, (none, some), seeds = self.fixpair, found.half, len(self.matched.seeds)
        d = found.difference = Difference()
        fixpair.matched_difference(byref(d), some.f_nl, none.f_nl, seeds)
        found.gauss, sigma, gain, layout = some.on_mean.peak - none.on_mean.peak, Double(), Double(), Layout()
        fixpair.difference_sigma(byref(sigma), some.on_mean.half_width, none.on_mean.half_width, d.correlation)
        found.control = ControlVariate()
        fixpair.control_variates_scratch(byref(layout), seeds)
        block, scratch = memory(layout)
        fixpair.control_variates(byref(found.control), 1, some.f_nl, none.f_nl, seeds, doubles([0.0]), None, BETA_OPTIMAL, 0.0, scratch,
                                 layout.size)
        del block
        fixpair.control_variate_gain(byref(gain), d.deviation_first, d.deviation_second, d.correlation, 1.0)
        found.gauss_sigma, found.difference_gain = sigma.value, gain.value
        found.matched = doubles([one - zero for one, zero in zip(some.f_nl, none.f_nl)])
        found.p = [self.find_p(some.b_g, f_nl) for f_nl in (some.f_nl, found.matched)]

    def find_p(self, b_g, f_nl):
        p, error, each = Double(), Double(), []
        for bias, estimate in zip(b_g, f_nl):
            self.fixpair.universality(byref(p), byref(error), bias, 0.0, estimate, 0.0, 0.0, self.matched.f_nl[1])
            each.append(p.value)
        mean, deviation = self.moments([doubles(each)], 1)
        return mean[0], deviation[0]

    def volumes(self, reference, scatters, simulations):
        volume, found = Double(), []
        for scatter in scatters:
            self.fixpair.effective_volume(byref(volume), reference, 1, scatter, simulations)
            found.append(volume.value)
        return found

    def compare(self, found):
        """V_eff/V over Normal simulations that are not matched: of f100, and of the difference."""
        found.volume = found.volume_error = found.volume_on_mean = (math.nan, math.nan)
        normal = self.types.get(NORMAL)
        if normal is None:
            return
        d = found.difference
        found.volume = self.volumes(normal.difference.deviation_first, (d.deviation_first, d.deviation), found.simulations)
        found.volume_on_mean = self.volumes(normal.half[1].on_mean.half_width, (found.half[1].on_mean.half_width, found.gauss_sigma),
                                            found.simulations)
        seeds, replicates = len(self.matched.seeds), []
        indices = (Long * seeds)()
        for replicate in range(REPLICATES):
            self.fixpair.bootstrap_indices(indices, seeds, seeds, BOOTSTRAP_SEED, replicate)
            reference, *scatters = (self.moments([doubles([values[i] for i in indices])], 1)[1][0]
                                    for values in (normal.half[1].f_nl, found.half[1].f_nl, found.matched))
            replicates.append(self.volumes(reference, scatters, found.simulations))
        found.volume_error = [self.moments([doubles(list(volumes))], 1)[1][0] for volumes in zip(*replicates)]


# ---- Tables: common/matched_report.c.

GROUPS = (0.0, 0.03, 0.09, 0.2, 0.4)
PAPER = {(FIXED, 0): (0.141, 0.114, 1.174), (FIXED, 1): (0.110, 0.110, 1.081), (FIXED_PAIRED, 0): (0.177, 0.224, 1.224),
         (FIXED_PAIRED, 1): (0.120, 0.156, 1.056)}


def print_scatter(analysis):
    matched = analysis.matched
    groups = list(zip(GROUPS, GROUPS[1:]))
    print("\nScatter per simulation over Gaussian theory, sigma/sigma_th")
    print("%-14s %5s" % ("k [h/Mpc]", "f_NL") + "".join("  %4.2f-%4.2f" % group for group in groups))
    for found in analysis.types.values():
        for f_nl, half in zip(matched.f_nl, found.half):
            line = "%-14s %5g" % (found.name, f_nl)
            for low, high in groups:
                ratios = [s / t for k, s, t in zip(matched.k, half.sigma, half.theory) if low <= k < high]
                total = 0.0
                for ratio in ratios:
                    total += ratio * ratio
                line += "  %9.3f" % math.sqrt(total / len(ratios)) if ratios else "  %9s" % "--"
            print(line)


def print_fits(analysis):
    print("\nFits of sigma_r to the scatter below the highest k [tab:fits of the paper, f_NL = 0 and 100]")
    print("%-14s %5s  %-24s %-24s %-24s  chi^2/bins" % ("", "f_NL", "R_cv", "k_soft [h/Mpc]", "f_sn"))
    for name, number in PAPER:
        fit = name in analysis.types and analysis.types[name].half[number].fit
        if not fit:
            continue
        value, error, known = fit.value, fit.error, PAPER[name, number]
        print("%-14s %5g  %.3f +- %.3f [%.3f]  %.3f +- %.3f [%.3f]  %.3f +- %.3f [%.3f]   %.0f/%d" % (
            name, analysis.matched.f_nl[number], value.cosmic_variance, error.cosmic_variance, known[0], value.softening,
            error.softening, known[1], value.shot_noise, error.shot_noise, known[2], fit.chi_squared, analysis.scatter_bins))


def volume_text(volume, on_mean):
    return "  %12s" % "--" if math.isnan(volume) else "  %5.1f [%4.1f]" % (volume, on_mean)


def print_row(found):
    d, none, some = found.difference, found.half[0].on_mean, found.half[1].on_mean
    volumes = [volume_text(*both) for both in zip(found.volume, found.volume_on_mean)]
    paired = found.simulations == 2
    shown = [volume_text(math.nan, math.nan)] * 2 if paired else volumes
    print("%-14s %6.1f +- %5.1f  %6.1f +- %5.1f  %6.1f +- %5.1f  %6.1f +- %5.1f" % (
        found.name, d.mean_second, d.deviation_second, none.centre, none.half_width, d.mean_first, d.deviation_first, some.centre,
        some.half_width) + shown[0] + "  %5.2f  %6.1f +- %4.1f  %6.1f +- %4.1f" % (
        d.correlation, d.mean, d.deviation, found.gauss, found.gauss_sigma) + shown[1])
    if not paired:
        return
    r = math.sqrt(2.0)
    print("%14s %6s +- %5.1f  %6s +- %5.1f  %6s +- %5.1f  %6s +- %5.1f" % (
        "x sqrt(2)", "", r * d.deviation_second, "", r * none.half_width, "", r * d.deviation_first, "", r * some.half_width) + volumes[0]
        + "  %5s  %6s +- %4.1f  %6s +- %4.1f" % ("", "", r * d.deviation, "", r * found.gauss_sigma) + volumes[1])


def print_table(analysis):
    print("\nf_NL of each simulation or pair, mean +- scatter; of the mean spectrum; V_eff/V over a Normal simulation by scatter "
          "[by the mean]")
    print("%-14s %-15s  %-15s  %-15s  %-15s  %12s  %5s  %-14s  %-14s  %12s" % (
        "", "  <f0> +- std", "  Mean", "  <f1> +- std", "  Mean", "V_eff/V", "rho", " <f1 - f0>", " Gaussian", "V_eff/V"))
    for found in fitted(analysis):
        print_row(found)
    print("f0, f1: universes of f_NL = %g, %g" % tuple(analysis.matched.f_nl))


def fitted(analysis):
    return [found for found in analysis.types.values() if found.name in FITTED]


def print_worth(analysis):
    seeds = len(analysis.matched.seeds)
    print("\nMatched: f1 - beta f0, errors of the means of %d; and p from f1, and from f1 - f0, mean +- scatter" % seeds)
    print("%-14s %-16s %-16s  %8s  %6s %-16s  %8s  %-16s %-16s" % (
        "", "  f1", "  beta = 1", "gain", "beta", "  optimal beta", "gain", "  p from f1", "  p from f1 - f0"))
    for found in fitted(analysis):
        d, control = found.difference, found.control
        print("%-14s %7.2f +- %5.2f %7.2f +- %5.2f  %8.2f  %6.3f %7.2f +- %5.2f  %8.2f  %6.3f +- %5.3f  %6.3f +- %5.3f" % (
            found.name, d.mean_first, d.deviation_first / math.sqrt(seeds), d.mean, d.error_of_mean, found.difference_gain, control.beta,
            control.mean, control.error, control.gain, *found.p[0], *found.p[1]))
    for found in fitted(analysis):
        off = found.difference.mean_second / (found.difference.deviation_second / math.sqrt(seeds))
        if abs(off) >= 3.0:
            print("%s: <f0> is %.1f errors from the 0 that the optimal beta supposes. Does the model hold up to the highest k?\n"
                  "Trust beta = 1, from which drops out what both share" % (found.name, off))
    print("\nErrors of V_eff/V, by bootstrap over seeds")
    for found in fitted(analysis):
        if found.name != NORMAL and not math.isnan(found.volume[0]):
            print("%-14s %5.1f +- %4.1f, matched %5.1f +- %4.1f" % (
                found.name, found.volume[0], found.volume_error[0], found.volume[1], found.volume_error[1]))


def print_report(analysis):
    matched = analysis.matched
    print("%d seeds, V = (%g Mpc/h)^3, %.0f halos; %d bins: %d for the scatter, %d for f_NL" % (
        len(matched.seeds), matched.box, matched.halos[0], matched.bins, analysis.scatter_bins, analysis.bias_bins))
    print_scatter(analysis)
    print_fits(analysis)
    print_table(analysis)
    print_worth(analysis)


def lines_of_half(analysis, half):
    for k, sigma, error, theory, used in zip(analysis.matched.k, half.sigma, half.error, half.theory, half.used):
        yield k, "sigma", sigma, error
        yield k, "sigma_th", theory, None
        yield k, "sigma of an estimate", used, None
    if half.fit:
        yield None, "R_cv", half.fit.value.cosmic_variance, half.fit.error.cosmic_variance
        yield None, "k_soft", half.fit.value.softening, half.fit.error.softening
        yield None, "f_sn", half.fit.value.shot_noise, half.fit.error.shot_noise
        yield None, "chi^2", half.fit.chi_squared, None
    if half.f_nl:
        yield None, "f of the mean", half.on_mean.centre, half.on_mean.half_width
        yield None, "peak of the mean", half.on_mean.peak, None


def lines_of_type(found, names):
    zero, one, both = names
    d, control = found.difference, found.control
    yield zero, "<f> +- std", d.mean_second, d.deviation_second
    yield one, "<f> +- std", d.mean_first, d.deviation_first
    yield one, "V_eff/V", found.volume[0], found.volume_error[0]
    yield one, "V_eff/V of the mean", found.volume_on_mean[0], None
    yield one, "p", *found.p[0]
    yield both, "rho", d.correlation, d.correlation_error
    yield both, "<f> +- std", d.mean, d.deviation
    yield both, "Gaussian", found.gauss, found.gauss_sigma
    yield both, "V_eff/V", found.volume[1], found.volume_error[1]
    yield both, "V_eff/V of the mean", found.volume_on_mean[1], None
    yield both, "p", *found.p[1]
    yield both, "gain of beta = 1", found.difference_gain, None
    yield both, "f of the optimal beta", control.mean, control.error
    yield both, "optimal beta", control.beta, None
    yield both, "gain of the optimal beta", control.gain, None


def write_report(analysis, path):
    halves = ["%g" % f_nl for f_nl in analysis.matched.f_nl]
    names = (*halves, f"{halves[1]}-{halves[0]}")
    with open(path, "w", encoding="utf-8") as file:
        def write(name, f_nl, k, quantity, value, error):
            if not math.isnan(value):
                k, error = ("" if number is None else "%.17g" % number for number in (k, error))
                file.write(f"{name},{f_nl},{k},{quantity},{value:.17g},{error}\n")
        file.write("type,f_NL,k [h/Mpc],quantity,value,error\n")
        for found in analysis.types.values():
            for f_nl, half in zip(halves, found.half):
                for line in lines_of_half(analysis, half):
                    write(found.name, f_nl, *line)
            if found.name in FITTED:
                for f_nl, *line in lines_of_type(found, names):
                    write(found.name, f_nl, None, *line)


def main():
    folder = pathlib.Path(__file__).resolve().parent.parent
    suffix = {"darwin": "libfixpair.dylib", "win32": "fixpair.dll"}.get(sys.platform, "libfixpair.so")
    parser = argparse.ArgumentParser(description="f_NL from matched spectra; TABLE as 05_matched_fnl --help describes it.")
    parser.add_argument("tables", nargs="+", metavar="TABLE")
    parser.add_argument("--library", default=folder / "target" / "release" / suffix, help="default: %(default)s")
    parser.add_argument("--linear", default=folder / "examples" / "data" / "camb_goliat_linear.txt", metavar="FILE")
    parser.add_argument("--box", type=float, default=1000.0, help="Mpc/h")
    parser.add_argument("--redshift", type=float, default=1.0, help="of the halos")
    parser.add_argument("--omega-m", type=float, help="default: 0.27")
    parser.add_argument("--n-s", type=float, help="default: 0.96")
    parser.add_argument("--lss", action="store_true", help="f_NL in the LSS convention")
    parser.add_argument("--k-scatter", type=float, default=0.4, help="h/Mpc")
    parser.add_argument("--k-bias", type=float, default=0.09, help="h/Mpc")
    parser.add_argument("--measured", action="store_true", help="fit f_NL with the measured scatter")
    parser.add_argument("--table", metavar="FILE", help="write all numbers as CSV")
    choice = parser.parse_args()
    try:
        linear, arrays = read_linear(choice.linear)
        analysis = Analysis(Library(choice.library), read_matched(choice.tables, choice.box), choice, linear)
        del arrays
        print_report(analysis)
        if choice.table:
            write_report(analysis, choice.table)
    except (OSError, ValueError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
