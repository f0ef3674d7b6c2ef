//! The self-test passes good transforms in any layout, and catches each way of breaking the contract.

use super::*;
use crate::reference::parts::together;

/// What a hook may get wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    None,
    Sign,
    DividesForward,
    DividesInverse,
    SwapsAxes,
    OtherHalf,
    ForwardElsewhere,
    InverseElsewhere,
    ReadsPadding,
    Fails,
}

struct Broken<'a, T: Real> {
    inner: Transform<'a, T>,
    fault: Fault,
}

impl<T: Real> Broken<'_, T> {
    /// Rearranges the modes: the new value at `at` is the old one at the index that `from` gives, conjugated if asked.
    fn rearrange(&self, data: &mut [T], conjugate: bool, from: impl Fn([usize; 2]) -> [usize; 2]) {
        let (n, h) = (self.inner.fourier().n(), self.inner.fourier().n() / 2 + 1);
        let modes = modes_of(&self.inner, data);
        let [sx, sy, _] = self.inner.fourier().stride();
        for i in 0..n * n * h {
            let [x, y] = from([i / (n * h), i / h % n]);
            let [re, im] = modes[(x * n + y) * h + i % h];
            let address = 2 * (i / (n * h) * sx + i / h % n * sy + i % h);
            data[address] = T::from_f64(re);
            data[address + 1] = T::from_f64(if conjugate { -im } else { im });
        }
    }

    fn spoil_modes(&self, data: &mut [T]) {
        let n = self.inner.fourier().n();
        match self.fault {
            Fault::Sign => self.rearrange(data, true, |at| at),
            Fault::SwapsAxes => self.rearrange(data, false, |[x, y]| [y, x]),
            Fault::OtherHalf => self.rearrange(data, true, |at| at.map(|i| (n - i) % n)),
            _ => {}
        }
    }

    fn divide(&self, data: &mut [T]) {
        let n = self.inner.fourier().n();
        data.iter_mut().for_each(|x| *x = *x / T::from_f64((n * n * n) as f64));
    }
}

impl<T: Real> Fft3<T> for Broken<'_, T> {
    fn configuration(&self) -> &Brick {
        self.inner.configuration()
    }

    fn fourier(&self) -> &Brick {
        self.inner.fourier()
    }

    fn length(&self) -> usize {
        self.inner.length()
    }

    fn forward(&mut self, data: &mut [T]) -> Result<()> {
        match self.fault {
            Fault::ForwardElsewhere => return self.inner.forward(&mut data.to_vec()),
            Fault::Fails => return Err(Error::Hook),
            Fault::ReadsPadding => data[0] += data[self.inner.configuration().n()],
            _ => {}
        }
        self.inner.forward(data)?;
        self.spoil_modes(data);
        if self.fault == Fault::DividesForward {
            self.divide(data);
        }
        Ok(())
    }

    fn inverse(&mut self, data: &mut [T]) -> Result<()> {
        if self.fault == Fault::InverseElsewhere {
            return self.inner.inverse(&mut data.to_vec());
        }
        self.spoil_modes(data);
        self.inner.inverse(data)?;
        if self.fault == Fault::DividesInverse {
            self.divide(data);
        }
        Ok(())
    }
}

fn verdict<T: Real>(n: usize, fault: Fault) -> Result<()> {
    let mut memory = Memory::new(Tables::<T>::layout(n).unwrap());
    let mut work = Memory::new(Transform::<T>::workspace(n).unwrap());
    let tables = Tables::<T>::new(n, memory.bytes()).unwrap();
    let cells = Brick::whole_padded(n, Space::Configuration, 2).unwrap();
    let inner = Transform::new(&tables, cells, work.bytes(), &Serial).unwrap();
    let mut hook = Broken { inner, fault };
    let mut data = vec![T::ZERO; hook.length()];
    self_test(&mut hook, &mut data)
}

#[test]
fn the_self_test_passes_the_built_in_transform() {
    for n in SIDES {
        assert_eq!(verdict::<f64>(n, Fault::None), Ok(()), "{n}");
        assert_eq!(verdict::<f32>(n, Fault::None), Ok(()), "{n}");
    }
}

#[test]
fn the_self_test_catches_every_fault() {
    use Fault::*;
    let faults = [
        Sign,
        DividesForward,
        DividesInverse,
        SwapsAxes,
        OtherHalf,
        ForwardElsewhere,
        InverseElsewhere,
        ReadsPadding,
        Fails,
    ];
    for fault in faults {
        for n in [4, 6, 8, 12, 20, 64] {
            assert_eq!(verdict::<f64>(n, fault), Err(Error::Hook), "{fault:?} {n}");
            assert_eq!(verdict::<f32>(n, fault), Err(Error::Hook), "{fault:?} {n}");
        }
    }
}

#[test]
fn the_self_test_wants_an_array_of_the_hooks_length() {
    with_transform::<f64, _>(8, 0, Simd::detect(), &Serial, |fft| {
        let mut data = vec![0.0; fft.length() + 1];
        assert_eq!(self_test(fft, &mut data), Err(Error::Length));
        assert!(data.iter().all(|&x| x == 0.0));
    });
}

#[test]
fn the_self_test_passes_slabs_with_transposed_modes() {
    // The third process holds nothing.
    together::<f64>(10, &[(0, 7), (7, 3), (10, 0)], &|process| {
        let mut data = vec![0.0; process.length()];
        assert_eq!(self_test(process, &mut data), Ok(()));
    });
}
