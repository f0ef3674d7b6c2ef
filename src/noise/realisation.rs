//! Which universe: the choices that, with the mode number, determine every mode.

use crate::status::{Error, Result};

/// How random numbers become modes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Scheme {
    /// Philox4x32-10 at the signed mode number.
    #[default]
    Native = 0,
    /// RANLUX (ranlxd1) seeded for each (i, j) from a table: the scheme of N-GenIC, 2LPTic, 2LPTPNG and L-PICOLA.
    NGenIc = 1,
    /// The same with FastPM's choices on the self-conjugate and Nyquist planes.
    FastPm = 2,
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

/// The region of mode numbers (i, j, l) that [`Realisation::sample`] bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Selection {
    /// |i|, |j| and |l| at most floor(sample/2).
    #[default]
    Cube = 0,
    /// i^2 + j^2 + l^2 at most floor(sample/2)^2 (2LPTic's `SphereMode`).
    Sphere = 1,
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
    /// Which modes are drawn: the others are +0, in every scheme.
    pub selection: Selection,
    /// Twice the largest mode number that is drawn (2LPTic's `Nsample`). 0 stands for the side n of the mesh, with which
    /// a cube is all its modes.
    pub sample: u32,
}

impl Realisation {
    /// Native, normal, original, Nyquist planes zero, no mode left out.
    ///
    /// ```
    /// use fixpair::noise::{Amplitude, Phase, Realisation};
    ///
    /// let fixed_inverted = Realisation { amplitude: Amplitude::Fixed, phase: Phase::Inverted, ..Realisation::new(5) };
    /// assert_eq!(fixed_inverted.seed, 5);
    /// ```
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// How many modes (i, j, l), from l = 0 upwards, may be other than zero on a mesh of side n: none or some but those of
    /// l = n/2 where Nyquist planes are zero, and none beyond the selection.
    #[inline(always)]
    pub(super) fn modes_along_l(&self, n: usize, i: i64, j: i64) -> usize {
        let half = (n / 2) as i64;
        let zero_nyquist = self.nyquist == Nyquist::Zero;
        if zero_nyquist && (i == half || j == half) {
            return 0;
        }
        let reach = if self.sample == 0 { half } else { i64::from(self.sample / 2) };
        let last = match self.selection {
            Selection::Cube if i.abs() > reach || j.abs() > reach => return 0,
            Selection::Cube => reach,
            Selection::Sphere => match reach * reach - (i * i + j * j) {
                rest if rest < 0 => return 0,
                rest => rest.isqrt(),
            },
        };
        last.min(half - i64::from(zero_nyquist)) as usize + 1
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
from_number!(Scheme: Native, NGenIc, FastPm);
from_number!(Amplitude: Normal, Fixed, FixedToMean);
from_number!(Phase: Original, Inverted);
from_number!(Nyquist: Zero, Filled);
from_number!(Selection: Cube, Sphere);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_c_passes_are_checked() {
        assert_eq!(Scheme::try_from(0), Ok(Scheme::Native));
        assert_eq!(Scheme::try_from(1), Ok(Scheme::NGenIc));
        assert_eq!(Scheme::try_from(2), Ok(Scheme::FastPm));
        assert_eq!(Scheme::try_from(3), Err(Error::Choice));
        assert_eq!(Amplitude::try_from(2), Ok(Amplitude::FixedToMean));
        assert_eq!(Amplitude::try_from(3), Err(Error::Choice));
        assert_eq!(Phase::try_from(1), Ok(Phase::Inverted));
        assert_eq!(Phase::try_from(-1), Err(Error::Choice));
        assert_eq!(Nyquist::try_from(1), Ok(Nyquist::Filled));
        assert_eq!(Nyquist::try_from(i32::MIN), Err(Error::Choice));
        assert_eq!(Selection::try_from(1), Ok(Selection::Sphere));
        assert_eq!(Selection::try_from(2), Err(Error::Choice));
    }
}
