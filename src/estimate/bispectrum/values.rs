//! From sums to spectra.

use super::triangles::{Triangle, check_triangles};
use crate::estimate::exact::ExactSum;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

fn check_finite(values: &[f64]) -> Result<()> {
    if values.iter().all(|&x| Real::is_finite(x)) { Ok(()) } else { Err(Error::NotFinite) }
}

/// The sums over cells as numbers, each rounded once.
///
/// # Errors
/// `Length` unless there is a value for each sum; `NotFinite` if a sum lost a term. `values` is untouched by both.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::bispectrum_values;
/// use fixpair::estimate::exact::ExactSum;
///
/// let (mut sum, mut value) = (ExactSum::ZERO, [0.0]);
/// sum.add(2.5);
/// bispectrum_values(&mut value, &[sum])?;
/// assert_eq!(value, [2.5]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum_values(values: &mut [f64], sums: &[ExactSum]) -> Result<()> {
    if values.len() != sums.len() {
        return Err(Error::Length);
    }
    if sums.iter().any(|sum| !Real::is_finite(sum.value())) {
        return Err(Error::NotFinite);
    }
    for (value, sum) in values.iter_mut().zip(sums) {
        *value = sum.value();
    }
    Ok(())
}

/// B = V^2 (scale^3/n^3) value/count, and 0 where no triple of modes closes the triangle.
///
/// `values`: from [`bispectrum_values`], replaced by B. `counts`: from [`super::triangle_counts`]. `scale`: what the modes have
/// yet to be multiplied by to be delta_k with delta(x) = sum_k delta_k exp(+i k.x): 1, or 1/n^3 after a forward transform that does
/// not divide. V = `box_size`^3; B comes in its unit to the sixth power, (Mpc/h)^6.
///
/// # Errors
/// `Length` unless there is a count for each value, `MeshSize` for n = 0, `NotFinite` for box, scale or values, `Range` for a box
/// that is not positive, and if a result overflows. `values` is untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::normalise;
///
/// let mut values = [54066.0 * 64.0_f64.powi(3)]; // sum over cells of a product of three shells whose modes are all 1
/// normalise(&mut values, &[54066], 64, 1000.0, 1.0)?;
/// assert!((values[0] / 1e18 - 1.0).abs() < 1e-12); // V^2 <delta delta delta>
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn normalise(values: &mut [f64], counts: &[u64], n: usize, box_size: f64, scale: f64) -> Result<()> {
    if values.len() != counts.len() {
        return Err(Error::Length);
    }
    if n == 0 {
        return Err(Error::MeshSize);
    }
    check_finite(&[box_size, scale])?;
    check_finite(values)?;
    if box_size <= 0.0 {
        return Err(Error::Range);
    }
    let volume = box_size * box_size * box_size;
    let side = scale / n as f64;
    let factor = volume * volume * (side * side * side);
    let spectrum = |value: f64, count: u64| if count == 0 { 0.0 } else { factor * value / count as f64 };
    if values.iter().zip(counts).any(|(&value, &count)| !Real::is_finite(spectrum(value, count))) {
        return Err(Error::Range);
    }
    for (value, &count) in values.iter_mut().zip(counts) {
        *value = spectrum(*value, count);
    }
    Ok(())
}

/// out = of(P_i, P_j, P_k, number of the triangle), once all results are known to be finite.
fn combine(
    out: &mut [f64],
    triangles: &[Triangle],
    power: &[f64],
    of: impl Fn([f64; 3], usize) -> f64,
) -> Result<()> {
    check_triangles(triangles, power.len())?;
    if out.len() != triangles.len() {
        return Err(Error::Length);
    }
    check_finite(power)?;
    let value = |t: usize| of(triangles.at(t).map(|shell| power.at(shell as usize)), t);
    if (0..out.len()).any(|t| !Real::is_finite(value(t))) {
        return Err(Error::Range);
    }
    for (t, out) in out.iter_mut().enumerate() {
        *out = value(t);
    }
    Ok(())
}

/// The shot noise of B of points of equal weight: (P_i + P_j + P_k) noise + noise^2.
///
/// `power`: P of each shell, free of shot noise. `noise`: 1/n for points of number density n. With weights the first term has V sum w^2/(sum w)^2
/// for noise, and the second is V^2 sum w^3/(sum w)^3, which is larger than noise^2: subtract that difference too.
///
/// # Errors
/// `Range` for a triangle of a shell without P and if a result overflows, `Length` unless there is a result for each triangle,
/// `NotFinite` for P and noise. `out` is untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::shot_noise;
///
/// let mut noise = [0.0];
/// shot_noise(&mut noise, &[[0, 0, 1]], &[100.0, 50.0], 10.0)?; // P free of shot noise, and 1/n
/// assert_eq!(noise, [(100.0 + 100.0 + 50.0) * 10.0 + 100.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn shot_noise(out: &mut [f64], triangles: &[Triangle], power: &[f64], noise: f64) -> Result<()> {
    check_finite(&[noise])?;
    combine(out, triangles, power, |[a, b, c], _| (a + b + c) * noise + noise * noise)
}

/// The reduced bispectrum Q = B/(P_i P_j + P_j P_k + P_k P_i); 0 where the denominator is.
///
/// `power`: P of each shell; both free of shot noise.
///
/// # Errors
/// As [`shot_noise`]; `Length` unless there is a B for each triangle, `NotFinite` for B.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::reduced;
///
/// let mut q = [0.0];
/// reduced(&mut q, &[3e4], &[[0, 0, 0]], &[100.0])?; // B/(P1 P2 + P2 P3 + P3 P1)
/// assert_eq!(q, [1.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn reduced(out: &mut [f64], bispectrum: &[f64], triangles: &[Triangle], power: &[f64]) -> Result<()> {
    if bispectrum.len() != triangles.len() {
        return Err(Error::Length);
    }
    check_finite(bispectrum)?;
    combine(out, triangles, power, |[a, b, c], t| {
        let products = a * b + b * c + c * a;
        if products == 0.0 { 0.0 } else { bispectrum.at(t) / products }
    })
}
