//! Tables of the built-in transform: roots of unity, radices and the reversal of digits, in the caller's memory.
//!
//! A mesh side n = R_1 R_2 ... R_p is transformed in p passes (Cooley and Tukey 1965, decimation in frequency). Pass s
//! works on blocks of length M_s = n / (R_1 ... R_(s-1)) and multiplies output q of butterfly j by exp(-2 pi i j q/M_s);
//! the last pass has no factors and stores with the digits reversed. Rows of n reals are n/2 complex numbers and one
//! untangling step, for which there are n/4 more roots.
//!
//! Memory: a header of one cache line, then for n and for n/2 the roots and the reversal, then the untangling roots; each
//! array begins on a cache line. The header makes built tables recognisable wherever they are viewed again.

use core::num::NonZero;

use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{ALIGN, Arena, Layout};
use crate::status::{Error, Result};
use crate::within::Within;

/// "fixpFFT" and the version of the arrangement below.
const MAGIC: u64 = u64::from_le_bytes(*b"fixpFFT\x01");

/// Most passes of any side that fits the address space: 3^13 > 2^20 > the largest side.
const MOST_PASSES: usize = 16;

/// The radices of a length, first pass first.
#[derive(Clone, Copy, Debug)]
struct Radices {
    list: [u8; MOST_PASSES],
    count: usize,
}

impl Radices {
    const EMPTY: Self = Self { list: [0; MOST_PASSES], count: 0 };

    fn push(&mut self, radix: u8) {
        self.list.put(self.count, radix);
        self.count += 1;
    }

    fn as_slice(&self) -> &[u8] {
        self.list.part(..self.count)
    }

    /// Radix 4 as often as possible (8 and 6 need more registers than there are, and save little), first; then what is
    /// left: an 8 (or a 6 beside a 3) if the power of two is odd, and the odd primes.
    fn of(length: usize) -> Result<Self> {
        if length == 0 || length > 1 << 20 {
            return Err(if length == 0 { Error::MeshSize } else { Error::Overflow });
        }
        let mut rest = length;
        let mut power = |prime: usize| {
            let mut count = 0;
            while rest.is_multiple_of(prime) {
                rest /= prime;
                count += 1;
            }
            count
        };
        let (mut twos, mut threes, fives, sevens) = (power(2), power(3), power(5), power(7));
        if rest != 1 {
            return Err(Error::MeshSize);
        }
        let tail = match (twos % 2, threes, twos) {
            (0, ..) => None,
            (_, 1.., _) => Some(6),
            (_, _, 3..) => Some(8),
            _ => Some(2),
        };
        match tail {
            Some(6) => (twos, threes) = (twos - 1, threes - 1),
            Some(8) => twos -= 3,
            Some(_) => twos -= 1,
            None => {}
        }
        let mut radices = Self::EMPTY;
        for (radix, count) in [(4, twos / 2), (7, sevens), (5, fives), (3, threes)] {
            (0..count).for_each(|_| radices.push(radix));
        }
        if let Some(radix) = tail {
            radices.push(radix);
        }
        if radices.count == 0 {
            radices.push(1);
        }
        Ok(radices)
    }

    /// All but the last.
    fn first(&self) -> impl DoubleEndedIterator<Item = NonZero<usize>> {
        self.list.iter().take(self.count - 1).filter_map(|&radix| NonZero::new(usize::from(radix)))
    }

    fn last(&self) -> NonZero<usize> {
        NonZero::new(usize::from(self.list.at(self.count - 1))).unwrap_or(NonZero::<usize>::MIN)
    }

    /// Complex roots in all passes but the last.
    fn roots(&self, length: usize) -> usize {
        let mut block = length;
        let mut total = 0;
        for radix in self.first() {
            block /= radix;
            total += block * (radix.get() - 1);
        }
        total
    }
}

/// exp(-2 pi i k/n) for k < n, the angle reduced exactly to an eighth of a turn, rounded once.
fn root(k: usize, n: usize) -> (f64, f64) {
    let eighth = (8 * k).checked_div(n).unwrap_or_default();
    let rest = 8 * k - eighth * n;
    let rest = if eighth % 2 == 1 { n - rest } else { rest };
    let (s, c) = if rest == n {
        (core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2)
    } else {
        libm::sincos(core::f64::consts::FRAC_PI_4 * (rest as f64 / n as f64))
    };
    match eighth {
        0 => (c, -s),
        1 => (s, -c),
        2 => (-s, -c),
        3 => (-c, -s),
        4 => (-c, s),
        5 => (-s, c),
        6 => (s, c),
        _ => (c, s),
    }
}

/// How to transform one line of `length` complex numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan<'a, T> {
    pub(super) length: usize,
    radices: Radices,
    /// (re, im) of all passes but the last; per pass and butterfly j the roots of outputs q = 1 .. R.
    pub(super) roots: &'a [T],
    /// Where each butterfly of the last pass begins to store.
    pub(super) reversal: &'a [u32],
}

impl<'a, T: Real> Plan<'a, T> {
    pub(super) fn radices(&self) -> &[u8] {
        self.radices.as_slice()
    }

    fn layout(layout: Layout, length: usize) -> Result<Layout> {
        let radices = Radices::of(length)?;
        layout.and::<u8>(2 * radices.roots(length) * size_of::<T>())?.and::<u32>(length / radices.last())
    }

    fn build(arena: &mut Arena, length: usize) -> Result<()> {
        let radices = Radices::of(length)?;
        let roots = numbers_mut::<T>(arena, 2 * radices.roots(length))?;
        let mut next = roots.chunks_exact_mut(2);
        let mut block = length;
        for radix in radices.first() {
            let span = block / radix;
            for (j, q) in (0..span).flat_map(|j| (1..radix.get()).map(move |q| (j, q))) {
                let (re, im) = root(j * q, block);
                if let Some(pair) = next.next() {
                    pair.copy_from_slice(&[T::from_f64(re), T::from_f64(im)]);
                }
            }
            block = span;
        }
        let reversal = arena.take::<u32>(length / radices.last())?;
        for (b, place) in reversal.iter_mut().enumerate() {
            let (mut digits, mut reversed, mut weight) = (b, 0, reversal_weight(&radices));
            for radix in radices.first().rev() {
                weight /= radix;
                reversed += digits % radix * weight;
                digits /= radix;
            }
            *place = reversed as u32;
        }
        Ok(())
    }

    fn view(memory: &mut &'a [u8], length: usize) -> Result<Self> {
        let radices = Radices::of(length)?;
        let roots = numbers::<T>(memory, 2 * radices.roots(length))?;
        let blocks = length / radices.last();
        // SAFETY: every bit pattern is a u32.
        let reversal = unsafe { cut(memory, blocks * size_of::<u32>())?.align_to::<u32>().1 };
        let reversal = reversal.get(..blocks).ok_or(Error::Alignment)?;
        // The kernels store where the reversal says, unchecked.
        if reversal.iter().any(|&place| place as usize >= blocks) {
            return Err(Error::Version);
        }
        Ok(Self { length, radices, roots, reversal })
    }
}

/// The product of all radices but the last: one more than the largest reversed number.
fn reversal_weight(radices: &Radices) -> usize {
    radices.first().map(NonZero::get).product()
}

/// The next `bytes` of `memory`, which goes on at the next cache line.
fn cut<'a>(memory: &mut &'a [u8], bytes: usize) -> Result<&'a [u8]> {
    let (piece, rest) = memory.split_at_checked(bytes.next_multiple_of(ALIGN)).ok_or(Error::Scratch)?;
    *memory = rest;
    piece.get(..bytes).ok_or(Error::Scratch)
}

fn numbers<'a, T: Real>(memory: &mut &'a [u8], count: usize) -> Result<&'a [T]> {
    // SAFETY: T is f32 or f64 (Real is sealed), and every bit pattern is one.
    let numbers = unsafe { cut(memory, count * size_of::<T>())?.align_to::<T>().1 };
    numbers.get(..count).ok_or(Error::Alignment)
}

fn numbers_mut<'a, T: Real>(arena: &mut Arena<'a>, count: usize) -> Result<&'a mut [T]> {
    // SAFETY: T is f32 or f64 (Real is sealed), and every bit pattern is one.
    let numbers = unsafe { arena.take::<u8>(count * size_of::<T>())?.align_to_mut::<T>().1 };
    numbers.get_mut(..count).ok_or(Error::Alignment)
}

/// The tables of one mesh side and number type: immutable, and shared by all transforms and threads that use them.
#[derive(Clone, Copy, Debug)]
pub struct Tables<'a, T> {
    n: usize,
    pub(super) columns: Plan<'a, T>,
    pub(super) rows: Plan<'a, T>,
    /// exp(-2 pi i k/n)/2 for k = 0 ..= n/4.
    pub(super) untangle: &'a [T],
}

impl<'a, T: Real> Tables<'a, T> {
    /// Memory for the tables of side n: about 3 n numbers and n/4 integers.
    ///
    /// # Errors
    /// `MeshSize` if n is zero, odd or has a prime factor other than 2, 3, 5 and 7; `Overflow` if a mesh of this side
    /// does not fit the address space.
    ///
    /// # Example
    /// ```
    /// use fixpair::fft::Tables;
    ///
    /// assert!(Tables::<f64>::layout(64)?.size < 8192); // about 3 n numbers
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn layout(n: usize) -> Result<Layout> {
        if n == 0 || !n.is_multiple_of(2) {
            return Err(Error::MeshSize);
        }
        Brick::whole(n, Space::Fourier)?;
        let layout = Layout::EMPTY.and::<u64>(ALIGN / 8)?;
        let layout = Plan::<T>::layout(layout, n)?;
        let layout = Plan::<T>::layout(layout, n / 2)?;
        layout.and::<u8>(2 * (n / 4 + 1) * size_of::<T>())
    }

    /// Builds the tables of side n in `memory`. About 3 n sines and cosines, by libm in f64.
    ///
    /// # Errors
    /// As [`Tables::layout`]; `Scratch` or `Alignment` if `memory` is not as it says.
    ///
    /// # Example
    /// ```
    /// use fixpair::fft::Tables;
    /// # #[repr(align(64))] struct Memory([u8; 1 << 13]);
    /// # let mut memory = Memory([0; 1 << 13]);
    /// # let memory = &mut memory.0;
    ///
    /// let tables = Tables::<f64>::new(64, memory)?; // of Tables::layout bytes, aligned to 64
    /// assert_eq!(tables.n(), 64);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(n: usize, memory: &'a mut [u8]) -> Result<Self> {
        let layout = Self::layout(n)?;
        let mut arena = Arena::new(memory, layout)?;
        let header = arena.take::<u64>(ALIGN / 8)?;
        header.fill(0);
        header[..4].copy_from_slice(&[MAGIC, n as u64, size_of::<T>() as u64, layout.size as u64]);
        Plan::<T>::build(&mut arena, n)?;
        Plan::<T>::build(&mut arena, n / 2)?;
        let untangle = numbers_mut::<T>(&mut arena, 2 * (n / 4 + 1))?;
        for (k, pair) in untangle.chunks_exact_mut(2).enumerate() {
            let (re, im) = root(k, n);
            pair.copy_from_slice(&[T::from_f64(0.5 * re), T::from_f64(0.5 * im)]);
        }
        Self::view(memory)
    }

    /// The tables that [`Tables::new`] built in `memory`, for whoever shares them.
    ///
    /// # Errors
    /// `Version` if `memory` does not hold tables of this number type; `Scratch` or `Alignment` as [`Tables::new`].
    ///
    /// # Example
    /// ```
    /// use fixpair::fft::Tables;
    /// # #[repr(align(64))] struct Memory([u8; 1 << 13]);
    /// # let mut memory = Memory([0; 1 << 13]);
    /// # let memory = &mut memory.0;
    ///
    /// Tables::<f64>::new(64, memory)?;
    /// assert_eq!(Tables::<f64>::view(memory)?.n(), 64); // built once, read by any number of transforms
    /// assert!(Tables::<f32>::view(memory).is_err());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn view(memory: &'a [u8]) -> Result<Self> {
        let mut rest = memory;
        if memory.len() < ALIGN {
            return Err(Error::Scratch);
        }
        if !memory.as_ptr().addr().is_multiple_of(ALIGN) {
            return Err(Error::Alignment);
        }
        // SAFETY: every bit pattern is a u64.
        let header = unsafe { cut(&mut rest, ALIGN)?.align_to::<u64>().1 };
        let &[magic, n, element, size, ..] = header else { return Err(Error::Alignment) };
        if magic != MAGIC || element != size_of::<T>() as u64 {
            return Err(Error::Version);
        }
        let n = usize::try_from(n).map_err(|_| Error::Version)?;
        let layout = Self::layout(n).map_err(|_| Error::Version)?;
        if size != layout.size as u64 {
            return Err(Error::Version);
        }
        let columns = Plan::view(&mut rest, n)?;
        let rows = Plan::view(&mut rest, n / 2)?;
        let untangle = numbers(&mut rest, 2 * (n / 4 + 1))?;
        Ok(Self { n, columns, rows, untangle })
    }

    /// Cells on a side of the mesh.
    ///
    /// ```
    /// use fixpair::fft::Tables;
    /// # #[repr(align(64))] struct Memory([u8; 1 << 13]);
    /// # let mut memory = Memory([0; 1 << 13]);
    ///
    /// assert_eq!(Tables::<f32>::new(48, &mut memory.0)?.n(), 48);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn n(&self) -> usize {
        self.n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radices_multiply_to_the_length() {
        for length in 1..3000_usize {
            let mut rest = length;
            for prime in [2, 3, 5, 7] {
                while rest.is_multiple_of(prime) {
                    rest /= prime;
                }
            }
            match Radices::of(length) {
                Ok(radices) => {
                    let product: usize = radices.as_slice().iter().map(|&r| usize::from(r)).product();
                    assert_eq!((product, rest), (length, 1));
                }
                Err(error) => assert!(error == Error::MeshSize && rest != 1, "{length}"),
            }
        }
        for length in [1 << 20, 531_441, 823_543, 390_625, 3 * 5 * 7 * 8192] {
            assert!(Radices::of(length).is_ok());
        }
    }

    #[test]
    fn roots_are_exact_on_the_axes_and_symmetric() {
        for n in [4_usize, 6, 8, 20, 84, 250, 256, 384] {
            for k in 0..n {
                let (re, im) = root(k, n);
                let angle = core::f64::consts::TAU * k as f64 / n as f64;
                // The oracle rounds its angle, at most 2 pi, to 4.4e-16.
                assert!((re - libm::cos(angle)).abs() < 1e-15 && (im + libm::sin(angle)).abs() < 1e-15);
                if k > 0 {
                    assert_eq!(root(n - k, n), (re, -im));
                }
            }
            if n % 4 == 0 {
                assert_eq!(
                    [root(0, n), root(n / 4, n)].map(|(a, b)| (a, b + 0.0)),
                    [(1.0, 0.0), (0.0, -1.0)]
                );
            }
        }
    }
}
