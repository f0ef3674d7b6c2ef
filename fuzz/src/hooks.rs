//! Loops and transforms as hosts pass them.

use core::ffi::c_void;
use core::ptr::null_mut;
use std::cell::RefCell;
use std::collections::BTreeMap;

use crate::c::*;
use crate::input::Input;
use crate::memory::{Memory, scratch};

type Body = unsafe extern "C" fn(argument: *mut c_void, index: usize);

/// From the last index to the first.
unsafe extern "C" fn backwards(_: *mut c_void, count: usize, body: Body, argument: *mut c_void) -> i32 {
    for index in (0..count).rev() {
        // SAFETY: the library's own body and argument, at an index that it asked for.
        unsafe { body(argument, index) };
    }
    0
}

/// Gives up half way.
unsafe extern "C" fn weary(_: *mut c_void, count: usize, body: Body, argument: *mut c_void) -> i32 {
    for index in 0..count / 2 {
        // SAFETY: as above.
        unsafe { body(argument, index) };
    }
    1
}

/// Says that all is done, and has left out the last index.
unsafe extern "C" fn forgetful(_: *mut c_void, count: usize, body: Body, argument: *mut c_void) -> i32 {
    for index in 0..count.saturating_sub(1) {
        // SAFETY: as above.
        unsafe { body(argument, index) };
    }
    0
}

thread_local! {
    static POOL: fixpair_exec = {
        let (mut threads, mut exec) = (null_mut(), fixpair_exec { context: null_mut(), parallel_for: None });
        must!(fixpair_threads_create(&mut threads, &mut exec, 2));
        exec
    };
}

/// None, a loop that keeps its contract, or now and then one that fails.
pub fn exec(input: &mut Input) -> Option<fixpair_exec> {
    let hook = |parallel_for| Some(fixpair_exec { context: null_mut(), parallel_for: Some(parallel_for) });
    match input.byte() % 64 {
        48..59 => hook(backwards),
        59 => Some(POOL.with(|pool| *pool)),
        60 | 61 => hook(weary),
        62 => hook(forgetful),
        63 => Some(fixpair_exec { context: null_mut(), parallel_for: None }),
        _ => None,
    }
}

/// As the library takes it.
pub fn pointer<T>(of: &Option<T>) -> *const T {
    of.as_ref().map_or(core::ptr::null(), |value| value)
}

/// Alignment and size, as a query said.
pub fn layout() -> Layout {
    Layout { size: 0, align: 0 }
}

/// Scratch as a query asked for it; nothing sensible where it was refused or asks for more than the targets use.
pub fn scratch_for(input: &mut Input, status: i32, layout: Layout) -> Memory<u8> {
    let needed = if status == 0 && layout.size <= 1 << 21 { layout.size } else { 256 };
    let memory = scratch(if input.odd(64) { needed.saturating_sub(1 + input.few(65)) } else { needed });
    input.shown.push((memory.pointer(), memory.bytes()));
    memory
}

macro_rules! built {
    ($r:ident, $of:ident, $made:ident) => {
        pastey::paste! {
            /// A built-in transform whose memory lives with it.
            pub struct [<Built $r>] {
                pub fft: [<fixpair_fft_ $r>],
                _tables: Memory<u8>,
                _scratch: Memory<u8>,
            }

            fn $made(n: usize) -> [<Built $r>] {
                let (mut tables_layout, mut scratch_layout) = (layout(), layout());
                must!([<fixpair_fft_tables_scratch_ $r>](&mut tables_layout, n));
                must!([<fixpair_fft_scratch_ $r>](&mut scratch_layout, n));
                let (tables, scratch) = (scratch(tables_layout.size), scratch(scratch_layout.size));
                must!([<fixpair_fft_tables_init_ $r>](tables.pointer().cast(), tables.len(), n));
                let brick = crate::bricks::whole(2, 0);
                let mut fft = [<fixpair_fft_ $r>] {
                    struct_size: 0, context: null_mut(), forward: None, inverse: None, sum: None,
                    configuration: brick, fourier: brick, length: 0,
                };
                must!([<fixpair_fft_init_ $r>](
                    &mut fft, tables.pointer().cast(), tables.len(), 0, scratch.pointer().cast(), scratch.len(), core::ptr::null()
                ));
                [<Built $r>] { fft, _tables: tables, _scratch: scratch }
            }

            /// A built-in transform of side n, made once.
            pub fn $of(n: usize) -> [<fixpair_fft_ $r>] {
                thread_local! {
                    static MADE: RefCell<BTreeMap<usize, [<Built $r>]>> = const { RefCell::new(BTreeMap::new()) };
                }
                MADE.with_borrow_mut(|made| made.entry(n).or_insert_with(|| $made(n)).fft)
            }

            unsafe extern "C" fn [<broken_ $r>](_: *mut c_void, _: *mut $r) -> i32 {
                1
            }

            /// A transform of a small mesh, now and then with a member that is wrong.
            pub fn [<some_ $of>](input: &mut Input) -> [<fixpair_fft_ $r>] {
                let mut fft = $of(input.small_side());
                match input.byte() % 64 {
                    58 => fft.struct_size = input.size(),
                    59 => fft.forward = None,
                    60 => fft.forward = Some([<broken_ $r>]),
                    61 => fft.inverse = Some([<broken_ $r>]),
                    62 => fft.configuration = crate::bricks::brick(input, 0),
                    63 => fft.fourier = crate::bricks::brick(input, 1),
                    _ => (),
                }
                fft
            }
        }
    };
}

built!(f64, double, make_double);
built!(f32, single, make_single);
