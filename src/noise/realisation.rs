//! Which universe: the choices that, with the mode number, determine every mode.

use crate::status::{Error, Result};

/// How random numbers become modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Scheme {
    /// Philox4x32-10 at the signed mode number.
    #[default]
    Native = 0,
}

/// The modulus of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Amplitude {
    /// Rayleigh: |w| = sqrt(-ln u2), <|w|^2> = 1, so that w is a complex Gaussian.
    #[default]
    Normal = 0,
    /// |w| = 1, the root mean square of Normal: a fixed field has exactly the input power. The choice of every
    /// public code (Angulo & Pontzen 2016, arXiv:1603.05253).
    Fixed = 1,
    /// |w| = sqrt(pi)/2, the mean of Normal (Eq. dirac of arXiv:2204.11103 as printed). Biased: the field has
    /// pi/4 = 0.785 of the input power (self-conjugate modes 2/pi).
    FixedToMean = 2,
}

/// The sign of the whole field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Phase {
    /// As drawn.
    #[default]
    Original = 0,
    /// Every phase plus pi: the exact negative, the second member of a pair.
    Inverted = 1,
}

/// What stands on the planes where a mode number is n/2: modes that the mesh cannot tell from their mirror images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Nyquist {
    /// +0: gradients have no Nyquist modes, and all that remain are shared with every finer mesh.
    #[default]
    Zero = 0,
    /// Modes like the others, keyed by +n/2, Hermitian with -n/2 standing for n/2.
    Filled = 1,
}

/// One realisation of the unit modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(C)]
pub struct Realisation {
    /// The key of the random numbers: any number is as good as any other.
    pub seed: u64,
    /// How random numbers become modes.
    pub scheme: Scheme,
    /// The modulus of a mode.
    pub amplitude: Amplitude,
    /// The sign of the field.
    pub phase: Phase,
    /// The Nyquist planes.
    pub nyquist: Nyquist,
}

impl Realisation {
    /// Normal, original, Nyquist planes zero.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }
}

macro_rules! from_number {
    ($choice:ident: $($variant:ident),+) => {
        impl TryFrom<i32> for $choice {
            type Error = Error;

            /// `Choice` if the number is none of the enumeration's.
            fn try_from(number: i32) -> Result<Self> {
                [$(Self::$variant),+].into_iter().find(|&choice| choice as i32 == number).ok_or(Error::Choice)
            }
        }
    };
}
from_number!(Scheme: Native);
from_number!(Amplitude: Normal, Fixed, FixedToMean);
from_number!(Phase: Original, Inverted);
from_number!(Nyquist: Zero, Filled);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_c_passes_are_checked() {
        assert_eq!(Scheme::try_from(0), Ok(Scheme::Native));
        assert_eq!(Scheme::try_from(1), Err(Error::Choice));
        assert_eq!(Amplitude::try_from(2), Ok(Amplitude::FixedToMean));
        assert_eq!(Amplitude::try_from(3), Err(Error::Choice));
        assert_eq!(Phase::try_from(1), Ok(Phase::Inverted));
        assert_eq!(Phase::try_from(-1), Err(Error::Choice));
        assert_eq!(Nyquist::try_from(1), Ok(Nyquist::Filled));
        assert_eq!(Nyquist::try_from(i32::MIN), Err(Error::Choice));
    }
}
