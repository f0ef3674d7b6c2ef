//! FFTW 3, if this machine has it: the peer that tests and benchmarks measure against, loaded when they run.

use std::ffi::{c_int, c_uint, c_void};
use std::sync::Mutex;
use std::vec::Vec;
use std::{format, vec};

use libloading::Library;

/// FFTW's planner is not thread-safe.
static PLANNER: Mutex<()> = Mutex::new(());

const MEASURE: c_uint = 0;
const ESTIMATE: c_uint = 1 << 6;

type Plan = *mut c_void;
type PlanR2c<T> = unsafe extern "C" fn(c_int, c_int, c_int, *mut T, *mut T, c_uint) -> Plan;
type Execute = unsafe extern "C" fn(Plan);

/// The number types of FFTW's libraries.
pub(super) trait Number: Copy + 'static {
    /// File name of the shared library.
    const LIBRARY: &'static str;
    /// Prefix of its functions.
    const PREFIX: &'static str;
}

impl Number for f64 {
    const LIBRARY: &'static str = "libfftw3.so.3";
    const PREFIX: &'static str = "fftw";
}

impl Number for f32 {
    const LIBRARY: &'static str = "libfftw3f.so.3";
    const PREFIX: &'static str = "fftwf";
}

/// In-place transforms of one array of side n, rows of n + 2 reals.
pub(super) struct Fftw<T: Number> {
    library: Library,
    plans: [Plan; 2],
    /// The array that is transformed: n n (n + 2) reals.
    pub(super) data: Vec<T>,
}

impl<T: Number> Fftw<T> {
    /// Plans both directions, measuring if asked. `None` if the library is not on this machine.
    pub(super) fn new(n: usize, measure: bool, zero: T) -> Option<Self> {
        let _one_at_a_time = PLANNER.lock().unwrap();
        // SAFETY: FFTW's initialisers do nothing but initialise FFTW.
        let library = unsafe { Library::new(T::LIBRARY) }.ok()?;
        let mut data = vec![zero; n * n * (n + 2)];
        let size = c_int::try_from(n).unwrap();
        let flags = if measure { MEASURE } else { ESTIMATE };
        let plans = ["plan_dft_r2c_3d", "plan_dft_c2r_3d"].map(|name| {
            let name = format!("{}_{name}", T::PREFIX);
            // SAFETY: both functions take (int, int, int, pointer, pointer, unsigned), and the array has FFTW's size.
            unsafe {
                let plan = library.get::<PlanR2c<T>>(name.as_bytes()).unwrap();
                plan(size, size, size, data.as_mut_ptr(), data.as_mut_ptr(), flags)
            }
        });
        assert!(plans.iter().all(|plan| !plan.is_null()));
        Some(Self { library, plans, data })
    }

    fn call(&self, name: &str, plan: usize) {
        let name = format!("{}_{name}", T::PREFIX);
        // SAFETY: both execute and destroy take a plan and return nothing; the plan's array lives as long as it does.
        unsafe { self.library.get::<Execute>(name.as_bytes()).unwrap()(self.plans[plan]) }
    }

    /// Cells to modes, exp(-i k.x), not normalised.
    pub(super) fn forward(&mut self) {
        self.call("execute", 0);
    }

    /// Modes to cells, not normalised.
    pub(super) fn inverse(&mut self) {
        self.call("execute", 1);
    }
}

impl<T: Number> Drop for Fftw<T> {
    fn drop(&mut self) {
        let _one_at_a_time = PLANNER.lock().unwrap();
        self.call("destroy_plan", 0);
        self.call("destroy_plan", 1);
    }
}
