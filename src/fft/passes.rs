//! One line of complex vectors through all passes of its plan.

use core::marker::PhantomData;
use core::num::NonZero;

use super::access::{Access, Line};
use super::butterfly::{Butterfly, Radix};
use super::lanes::{Complex, Kernel, Lanes};
use super::tables::Plan;

/// A pass with roots: `blocks` blocks of `R` times `span` elements, each transformed where it lies.
struct Pass<V: Lanes, I, O, const R: usize> {
    from: I,
    to: O,
    blocks: usize,
    span: usize,
    roots: *const V::Element,
    lanes: PhantomData<V>,
}

impl<V: Lanes, I: Access<V>, O: Access<V>, const R: usize> Kernel for Pass<V, I, O, R>
where
    Radix<R>: Butterfly<V, R>,
{
    #[inline(always)]
    unsafe fn run(self) {
        for block in 0..self.blocks {
            let base = block * self.span * R;
            let mut roots = self.roots;
            for j in base..base + self.span {
                // SAFETY: j + q span is inside the line; there are R - 1 roots for each of the span butterflies.
                unsafe {
                    let y = Radix::<R>::transformed(gather(self.from, j, self.span));
                    self.to.put(j, y[0]);
                    for q in 1..R {
                        self.to.put(j + q * self.span, y[q].times(roots.add(2 * (q - 1))));
                    }
                    roots = roots.add(2 * (R - 1));
                }
            }
        }
    }
}

/// The last pass: butterflies of neighbours, stored with the digits reversed.
struct LastPass<V, I, O, const R: usize> {
    from: I,
    to: O,
    blocks: usize,
    reversal: *const u32,
    lanes: PhantomData<V>,
}

impl<V: Lanes, I: Access<V>, O: Access<V>, const R: usize> Kernel for LastPass<V, I, O, R>
where
    Radix<R>: Butterfly<V, R>,
{
    #[inline(always)]
    unsafe fn run(self) {
        for block in 0..self.blocks {
            // SAFETY: there are `blocks` blocks of R elements in the line, and reversed numbers are below `blocks`.
            unsafe {
                let y = Radix::<R>::transformed(gather(self.from, block * R, 1));
                let place = *self.reversal.add(block) as usize;
                for q in 0..R {
                    self.to.put(place + q * self.blocks, y[q]);
                }
            }
        }
    }
}

/// `R` elements, `step` apart.
///
/// # Safety
/// They are inside the line.
#[inline(always)]
unsafe fn gather<V: Lanes, I: Access<V>, const R: usize>(
    from: I,
    first: usize,
    step: usize,
) -> [Complex<V>; R] {
    // SAFETY: the caller's.
    unsafe {
        let mut x = [from.get(first); R];
        for q in 1..R {
            x[q] = from.get(first + q * step);
        }
        x
    }
}

/// # Safety
/// `from` and `to` hold `blocks radix span` elements, `roots` those of the pass; the processor has the lanes.
unsafe fn pass<V: Lanes, I: Access<V>, O: Access<V>>(
    radix: u8,
    from: I,
    to: O,
    blocks: usize,
    span: usize,
    roots: *const V::Element,
) {
    macro_rules! enter {
        ($($r:literal)*) => {
            match radix {
                // SAFETY: the caller's.
                $($r => unsafe {
                    V::enter(Pass::<V, I, O, $r> { from, to, blocks, span, roots, lanes: PhantomData });
                },)*
                _ => debug_assert!(false, "no such radix"),
            }
        };
    }
    enter!(2 3 4 5 6 7 8);
}

/// # Safety
/// `from` and `to` hold `blocks radix` elements, apart unless `blocks` is 1; `reversal` is a table of `blocks` numbers
/// below `blocks`; the processor has the lanes.
unsafe fn last_pass<V: Lanes, I: Access<V>, O: Access<V>>(radix: u8, from: I, to: O, reversal: &[u32]) {
    let blocks = reversal.len();
    let reversal = reversal.as_ptr();
    macro_rules! enter {
        ($($r:literal)*) => {
            match radix {
                // SAFETY: the caller's.
                $($r => unsafe {
                    V::enter(LastPass::<V, I, O, $r> { from, to, blocks, reversal, lanes: PhantomData });
                },)*
                _ => debug_assert!(false, "no such radix"),
            }
        };
    }
    enter!(1 2 3 4 5 6 7 8);
}

/// The forward transform of a line, from `from` to `to`; both may be the same place, or `from` may be `line`.
///
/// # Safety
/// `from`, `to` and `line` hold `plan.length` complex vectors; `line` is apart from `to`; the processor has the lanes.
pub(super) unsafe fn transform<V: Lanes, I: Access<V>, O: Access<V>>(
    plan: &Plan<V::Element>,
    from: I,
    to: O,
    line: *mut V::Element,
) {
    let line = Line(line);
    let Some((&last, passes)) = plan.radices().split_last() else { return };
    let mut roots = plan.roots.as_ptr();
    let (mut blocks, mut span) = (1, plan.length);
    for (i, &radix) in passes.iter().enumerate() {
        let Some(r) = NonZero::new(usize::from(radix)) else { return };
        span /= r;
        // SAFETY: the plan's roots and reversal are those of its radices, whose product is its length.
        unsafe {
            if i == 0 {
                pass::<V, I, _>(radix, from, line, blocks, span, roots);
            } else {
                pass::<V, _, _>(radix, line, line, blocks, span, roots);
            }
            roots = roots.add(2 * span * (r.get() - 1));
        }
        blocks *= r.get();
    }
    // SAFETY: as above.
    unsafe {
        if passes.is_empty() {
            last_pass::<V, I, O>(last, from, to, plan.reversal);
        } else {
            last_pass::<V, _, O>(last, line, to, plan.reversal);
        }
    }
}
