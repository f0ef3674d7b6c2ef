//! GSL's ranlxd1, if this machine has it: the peer of the noise of N-GenIC, loaded when the bench runs.

use std::ffi::{c_ulong, c_void};

use libloading::Library;

/// A generator of GSL.
pub(super) struct Ranlxd1 {
    library: Library,
    state: *mut c_void,
    set: unsafe extern "C" fn(*mut c_void, c_ulong),
    uniform: unsafe extern "C" fn(*const c_void) -> f64,
}

impl Ranlxd1 {
    /// `None` if the library is not on this machine.
    pub(super) fn new() -> Option<Self> {
        // GSL asks its host for the functions of a CBLAS, which its generators do not call.
        let names = ["libgsl.so.27", "libgsl.so.28", "libgsl.so.25", "libgsl.so"];
        // SAFETY: GSL has no initialisers.
        let library = names.into_iter().find_map(|name| unsafe { Library::new(name) }.ok())?;
        // SAFETY: the types are those of gsl_rng.h: a pointer to the kind of generator, and functions of a generator.
        unsafe {
            let kind = *library.get::<*const *const c_void>(b"gsl_rng_ranlxd1").ok()?;
            let alloc =
                library.get::<unsafe extern "C" fn(*const c_void) -> *mut c_void>(b"gsl_rng_alloc").ok()?;
            let state = alloc(*kind);
            let set = *library.get(b"gsl_rng_set").ok()?;
            let uniform = *library.get(b"gsl_rng_uniform").ok()?;
            (!state.is_null()).then_some(Self { library, state, set, uniform })
        }
    }

    /// Starts the stream of a seed.
    pub(super) fn set(&mut self, seed: u32) {
        // SAFETY: the generator was allocated by the library.
        unsafe { (self.set)(self.state, c_ulong::from(seed)) }
    }

    /// The next number.
    #[inline]
    pub(super) fn uniform(&mut self) -> f64 {
        // SAFETY: the generator was allocated by the library.
        unsafe { (self.uniform)(self.state) }
    }
}

impl Drop for Ranlxd1 {
    fn drop(&mut self) {
        // SAFETY: the generator was allocated by the library and is not used again.
        unsafe {
            if let Ok(free) = self.library.get::<unsafe extern "C" fn(*mut c_void)>(b"gsl_rng_free") {
                free(self.state);
            }
        }
    }
}
