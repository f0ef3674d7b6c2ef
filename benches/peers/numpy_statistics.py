"""The statistics of benches/variance.rs by numpy and scipy, as analyses write them: name and median seconds a line."""

import math
import time

import numpy as np
from scipy.optimize import curve_fit

SAMPLES, BINS, POINTS = 1000, 200, 128
rng = np.random.default_rng(1)


def timed(name, run, repeats=9):
    run()
    times = []
    for _ in range(repeats):
        count, start = 0, time.perf_counter()
        while count == 0 or time.perf_counter() - start < 0.01:
            run()
            count += 1
        times.append((time.perf_counter() - start) / count)
    print(name, sorted(times)[repeats // 2])


def spectrum(bins):
    b = np.arange(1, bins + 1)
    k = 0.006283 * b
    return (k, 4e5 * k / (1.0 + (k / 0.02) ** 2) ** 1.2, 1.05e7 * k * k / (1.0 + (k / 0.05) ** 2), 4.0 * math.pi * b * b)


samples = rng.uniform(-1.0, 1.0, (SAMPLES, BINS))
timed("covariance", lambda: np.cov(samples, rowvar=False))
covariance = np.cov(samples, rowvar=False)
timed("root", lambda: np.linalg.cholesky(covariance))

_, linear, alpha, modes = spectrum(14)
power = (2.32 + 2.0 * 1.686 * 1.32 * 100.0 / alpha) ** 2 * linear
sigma = 0.3 * (power + 4000.0) * np.sqrt(2.0 / modes)


def model(_, b_g, f_nl):
    return (b_g + 2.0 * 1.686 * (b_g - 1.0) * f_nl / alpha) ** 2 * linear


timed("fit", lambda: curve_fit(model, alpha, power, p0=[2.0, 10.0], sigma=sigma))


def posterior():
    (b_g, f_nl), inverse = curve_fit(model, alpha, power, p0=[2.0, 10.0], sigma=sigma, absolute_sigma=True)
    error = np.sqrt(np.diag(inverse))
    b, f = (np.linspace(best - 5.0 * e, best + 5.0 * e, POINTS) for best, e in zip((b_g, f_nl), error))
    bias = b[:, None, None] + 2.0 * 1.686 * (b[:, None, None] - 1.0) * f[None, :, None] / alpha
    chi2 = (((power - bias**2 * linear) / sigma) ** 2).sum(axis=2)
    density = np.exp(-0.5 * (chi2 - chi2.min()))
    return [np.interp([0.16, 0.84], np.cumsum(of) / of.sum(), x) for of, x in ((density.sum(1), b), (density.sum(0), f))]


timed("posterior", posterior)

k, power, _, modes = spectrum(63)


def sigma_r(_, r_cv, k_soft, f_sn):
    return np.sqrt(2.0 / modes) * (power * (r_cv + (1.0 - r_cv) * 2.0 / math.pi * np.arctan(k / k_soft)) + f_sn * 4000.0)


scatter = sigma_r(k, 0.141, 0.114, 1.174) * (1.0 + 0.15 * rng.uniform(-1.0, 1.0, 63))
timed("suppression", lambda: curve_fit(sigma_r, k, scatter, p0=[0.2, 0.1, 1.0], sigma=scatter / math.sqrt(80.0)))

few, values = 200, 60
c = rng.uniform(-1.0, 1.0, (few, values))
y = c + 0.3 * rng.uniform(-1.0, 1.0, (few, values))


def carpool():
    both = np.cov(y, c, rowvar=False)
    beta = np.linalg.solve(both[values:, values:], both[values:, :values]).T
    rest = y - c @ beta.T
    return rest.mean(axis=0), np.cov(rest, rowvar=False) / few


timed("carpool", carpool)
