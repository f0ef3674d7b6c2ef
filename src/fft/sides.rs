//! Which sides the built-in transform takes: even, with no prime factor but 2, 3, 5 and 7.

use crate::mesh::{Brick, Space};

/// The smallest such side that is not below `least`, for products without aliasing; none if it does not fit.
///
/// ```
/// use fixpair::fft::next_side;
///
/// assert_eq!(next_side(3 * 64 / 2), Some(96)); // for products without aliasing
/// assert_eq!(next_side(11), Some(12)); // even, of factors 2, 3, 5, 7
/// ```
#[must_use]
pub fn next_side(least: usize) -> Option<usize> {
    let mut side = least.max(2).checked_next_multiple_of(2)?;
    // Gaps between such numbers are short: a few steps at any size that a mesh can have.
    while Brick::whole(side, Space::Configuration).is_ok() {
        let odd = [2, 3, 5, 7].into_iter().fold(side, |rest, factor| {
            core::iter::successors(Some(rest), |&rest| rest.is_multiple_of(factor).then(|| rest / factor))
                .last()
                .unwrap_or(rest)
        });
        if odd == 1 {
            return Some(side);
        }
        side += 2;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::next_side;

    #[test]
    fn next_sides_are_even_and_smooth() {
        let expected =
            [(0, 2), (1, 2), (15, 16), (21, 24), (22, 24), (26, 28), (66, 70), (384, 384), (386, 392)];
        for (least, side) in expected {
            assert_eq!(next_side(least), Some(side));
        }
        assert_eq!(next_side(1 << 21), None, "its cube does not fit");
        assert_eq!(next_side(usize::MAX), None);
        assert_eq!(next_side(usize::MAX - 1), None);
    }
}
