//! A periodic box: coordinates brought home, differences and distances to the nearest image.

use core::sync::atomic::{AtomicBool, Ordering};

use crate::exec::Exec;
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::scratch::{Arena, Layout, Plain};
use crate::status::{Error, Result};
use crate::within::Within;

/// The sides that are taken: squares of lengths in them neither vanish nor overflow.
const SMALLEST: f64 = 1e-100;
const LARGEST: f64 = 1e100;

/// `NotFinite`; `Range` unless 1e-100 <= L <= 1e100 and `T` holds it.
pub(super) fn check_box<T: Real>(box_size: f64) -> Result<()> {
    if !box_size.is_finite() {
        return Err(Error::NotFinite);
    }
    let edge = T::from_f64(box_size);
    if (SMALLEST..=LARGEST).contains(&box_size) && edge > T::ZERO && edge.is_finite() {
        Ok(())
    } else {
        Err(Error::Range)
    }
}

/// x modulo L, in [0, L): unchanged where it is there already, else the exact remainder rounded to `T`. Of finite x.
#[inline(always)]
pub(super) fn home<T: Real>(x: T, box_size: f64) -> T {
    let inside = (0.0..box_size).contains(&x.to_f64());
    if inside { x } else { fetch_home(x, box_size) }
}

#[cold]
fn fetch_home<T: Real>(x: T, box_size: f64) -> T {
    let rest = crate::math::fmod(x.to_f64(), box_size);
    let rest = T::from_f64(if rest < 0.0 { rest + box_size } else { rest });
    // What rounds up to the far edge is on the near one.
    if rest.to_f64() < box_size { rest } else { T::ZERO }
}

/// Place of a particle, brought home.
///
/// # Safety
/// There is a particle `i`.
#[inline(always)]
pub(super) unsafe fn place<T: Real>(positions: &Positions<'_, T>, i: usize, box_size: f64) -> [T; 3] {
    // SAFETY: as the caller says.
    unsafe { positions.get(i) }.map(|x| home(x, box_size))
}

/// The distance along one axis.
#[inline(always)]
pub(super) fn along(a: f64, b: f64, box_size: f64) -> f64 {
    let direct = libm::fabs(a - b);
    direct.min(box_size - direct)
}

/// d^2 of two places.
#[inline(always)]
pub(super) fn distance_squared<T: Real>(a: [T; 3], b: [T; 3], box_size: f64) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| along(a[axis].to_f64(), b[axis].to_f64(), box_size));
    (x * x + y * y) + z * z
}

/// a - b for the nearest image of a, of two coordinates at home.
#[inline(always)]
pub(super) fn difference(a: f64, b: f64, box_size: f64) -> f64 {
    let direct = a - b;
    if direct > 0.5 * box_size {
        direct - box_size
    } else if direct < -0.5 * box_size {
        direct + box_size
    } else {
        direct
    }
}

/// Piece number i of `total` particles in pieces of `length`.
pub(super) fn pieces(total: usize, length: usize, i: usize) -> core::ops::Range<usize> {
    let first = i * length;
    first..total.min(first + length)
}

/// Part number i of a list whose parts start at `starts`, the last of which is the end.
#[inline(always)]
pub(super) fn span(starts: &[u32], i: usize) -> core::ops::Range<usize> {
    starts.at(i) as usize..starts.at(i + 1) as usize
}

/// Are all coordinates finite?
pub(super) fn check_finite<T: Real>(positions: &Positions<'_, T>, exec: &dyn Exec) -> Result<()> {
    let lost = AtomicBool::new(false);
    let total = positions.len();
    exec.parallel_for(total.div_ceil(CHECKED), &|chunk| {
        let finite = pieces(total, CHECKED, chunk).fold(true, |finite, i| {
            // SAFETY: the particle exists.
            let place = unsafe { positions.get(i) };
            finite & place[0].is_finite() & place[1].is_finite() & place[2].is_finite()
        });
        if !finite {
            lost.store(true, Ordering::Relaxed);
        }
    })?;
    if lost.load(Ordering::Relaxed) { Err(Error::NotFinite) } else { Ok(()) }
}

/// Particles checked at a time.
const CHECKED: usize = 1 << 15;

/// Borrows bytes as values of one type.
pub(super) fn view<T: Plain>(bytes: &mut [u8], count: usize) -> Result<&mut [T]> {
    Arena::new(bytes, Layout::EMPTY.and::<T>(count)?)?.take(count)
}
