//! Deposit and read-out straight from their definition: every mesh point, every periodic image.

use crate::pm::Window;

/// B-spline of p factors, each one wide, at distance s. The top hat holds its lower edge.
pub(crate) fn spline(window: Window, s: f64) -> f64 {
    let a = s.abs();
    match window {
        Window::NearestGridPoint => f64::from(u8::from((-0.5..0.5).contains(&s))),
        Window::CloudInCell => (1.0 - a).max(0.0),
        Window::TriangularShapedCloud if a < 0.5 => 0.75 - a * a,
        Window::TriangularShapedCloud => 0.5 * (1.5 - a).max(0.0).powi(2),
        Window::PiecewiseCubicSpline if a < 1.0 => (4.0 - 6.0 * a * a + 3.0 * a * a * a) / 6.0,
        Window::PiecewiseCubicSpline => (2.0 - a).max(0.0).powi(3) / 6.0,
    }
}

/// Weight of mesh point i, at i + shift, for a particle at u; both in cells of a periodic axis of n of them.
pub(crate) fn weight(window: Window, n: usize, shift: f64, u: f64, i: usize) -> f64 {
    let u = u.rem_euclid(n as f64);
    (-4..=4).map(|image| spline(window, u - shift - i as f64 - f64::from(image) * n as f64)).sum()
}

/// W(x_c - x) for all cells c of the mesh, z fastest.
pub(crate) fn windows(window: Window, n: usize, shift: f64, u: [f64; 3]) -> std::vec::Vec<f64> {
    let along = u.map(|u| (0..n).map(|i| weight(window, n, shift, u, i)).collect::<std::vec::Vec<_>>());
    let cells = (0..n * n * n).map(|c| [c / (n * n), c / n % n, c % n]);
    cells.map(|[x, y, z]| along[0][x] * along[1][y] * along[2][z]).collect()
}
