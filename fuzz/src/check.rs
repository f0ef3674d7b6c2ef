//! What must hold after each call, whatever the input was.

use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use fixpair::capi::status::{FIXPAIR_ERROR_SINGULAR, FIXPAIR_OK};

use crate::memory::Memory;

/// Calls a function of the header and checks that its answer is a status.
#[macro_export]
macro_rules! call {
    ($name:ident($($argument:expr),* $(,)?)) => {{
        // SAFETY: each pointer is null, misaligned, or leads to as many initialised values as the header says, by the way that `Input` and `Memory` make them.
        let status = unsafe { $crate::c::$name($($argument),*) };
        $crate::check::sane(stringify!($name), status);
        // Here, so that each call has an edge of its own for it.
        if status == 0 {
            $crate::check::reached(stringify!($name));
        }
        status
    }};
}

/// A function of the header that cannot fail.
#[macro_export]
macro_rules! ask {
    ($name:ident($($argument:expr),* $(,)?)) => {{
        $crate::check::reached(stringify!($name));
        $crate::c::$name($($argument),*)
    }};
}

/// Calls what cannot fail with sound arguments.
#[macro_export]
macro_rules! must {
    ($name:ident($($argument:expr),* $(,)?)) => {
        assert_eq!($crate::call!($name($($argument),*)), 0, concat!(stringify!($name), ": the status"))
    };
}

pub fn sane(name: &'static str, status: i32) {
    assert!((FIXPAIR_ERROR_SINGULAR..=FIXPAIR_OK).contains(&status), "{name}: {status} is no status");
}

/// Where `run` asks for it, notes the names of the functions that did what they say.
pub fn reached(name: &'static str) {
    static FILE: OnceLock<Option<PathBuf>> = OnceLock::new();
    static NAMES: Mutex<BTreeSet<&str>> = Mutex::new(BTreeSet::new());
    let Some(path) = FILE.get_or_init(|| std::env::var_os("FIXPAIR_FUZZ_REACHED").map(Into::into)) else {
        return;
    };
    if NAMES.lock().is_ok_and(|mut names| names.insert(name)) {
        let mut file =
            OpenOptions::new().create(true).append(true).open(path).expect("a file to note names in");
        writeln!(file, "{name}").expect("room for a name");
    }
}

/// Outputs as they were before a call.
pub struct Before<'a>(Vec<(&'a dyn Hashed, u64)>);

/// Memory of any type.
pub trait Hashed {
    fn hashed(&self) -> u64;
}

impl<T> Hashed for Memory<T> {
    fn hashed(&self) -> u64 {
        self.hash()
    }
}

impl<'a> Before<'a> {
    pub fn of(outputs: &[&'a dyn Hashed]) -> Self {
        Self(outputs.iter().map(|&output| (output, output.hashed())).collect())
    }

    /// After a failure outputs are untouched, unless it is one of those after which they are undefined.
    pub fn check(&self, status: i32, undefined_after: &[i32]) {
        if status != FIXPAIR_OK && !undefined_after.contains(&status) {
            for (output, before) in &self.0 {
                assert_eq!(
                    output.hashed(),
                    *before,
                    "an output was touched by a call that failed with {status}"
                );
            }
        }
    }
}

/// What is OK is finite.
pub fn finite(status: i32, values: &[f64]) {
    assert!(status != FIXPAIR_OK || values.iter().all(|value| value.is_finite()), "OK, but {values:?}");
}
