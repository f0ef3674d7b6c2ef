//! Executors: the host's loop hook and the built-in pool.

use core::ffi::c_void;
use core::sync::atomic::{AtomicUsize, Ordering};

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::exec::{Exec, Serial};
use crate::status::{Error, Result};

/// How a kernel runs its loops. Every function that takes one accepts NULL: the calling thread does all the work.
///
/// parallel_for calls body(argument, index) exactly once for each index in 0 .. count-1, in any order, on any threads, and returns when
/// all calls have returned: 0, or anything else to give up, which makes the kernel return FIXPAIR_ERROR_HOOK with outputs
/// undefined, unless its block says otherwise. Results never depend on it, bit for bit. With OpenMP the whole hook is:
///
/// ```c
/// static int32_t openmp_for(void *context, size_t count, void (*body)(void *, size_t), void *argument) {
///     (void)context;
///     #pragma omp parallel for schedule(dynamic)
///     for (size_t i = 0; i < count; i++) body(argument, i);
///     return 0;
/// }
/// ```
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_exec {
    /// Handed to parallel_for as it is.
    pub context: *mut c_void,
    /// The loop.
    pub parallel_for: Option<
        unsafe extern "C" fn(
            context: *mut c_void,
            count: usize,
            body: unsafe extern "C" fn(argument: *mut c_void, index: usize),
            argument: *mut c_void,
        ) -> i32,
    >,
}

/// The host's loop, or none.
pub(super) enum HostExec {
    Serial,
    Hook(fixpair_exec),
}

// SAFETY: the documentation of the struct asks the host for a loop that any thread may run.
unsafe impl Sync for HostExec {}

impl HostExec {
    /// # Safety
    /// `exec` is null or points to a hook that keeps its contract.
    pub(super) unsafe fn new(border: &mut Border, exec: *const fixpair_exec) -> Result<Self> {
        if exec.is_null() {
            return Ok(Self::Serial);
        }
        // SAFETY: the caller's promise.
        let hook = *unsafe { border.read_one(exec) }?;
        if hook.parallel_for.is_none() { Err(Error::Null) } else { Ok(Self::Hook(hook)) }
    }
}

struct Chunks<'a> {
    body: &'a (dyn Fn(usize) + Sync),
    count: usize,
    done: AtomicUsize,
}

unsafe extern "C" fn run_chunk(argument: *mut c_void, index: usize) {
    // SAFETY: `argument` is the `Chunks` that `parallel_for` below keeps alive until the hook returns.
    let chunks = unsafe { &*argument.cast::<Chunks<'_>>() };
    if index < chunks.count {
        (chunks.body)(index);
        chunks.done.fetch_add(1, Ordering::Release);
    }
}

// SAFETY: the hook's contract is this trait's; chunks left out are noticed.
unsafe impl Exec for HostExec {
    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> Result<()> {
        let hook = match self {
            Self::Serial => return Serial.parallel_for(count, body),
            Self::Hook(hook) => hook,
        };
        let Some(parallel_for) = hook.parallel_for else { return Err(Error::Null) };
        let chunks = Chunks { body, count, done: AtomicUsize::new(0) };
        let argument = (&raw const chunks).cast_mut().cast::<c_void>();
        // SAFETY: the hook's contract; `chunks` outlives the call.
        let status = unsafe { parallel_for(hook.context, count, run_chunk, argument) };
        if status == 0 && chunks.done.load(Ordering::Acquire) == count { Ok(()) } else { Err(Error::Hook) }
    }
}

/// Tries a hook: loops of several lengths, checking that each index is run exactly once before the loop returns.
///
/// In:  exec  the hook to try (NULL passes)
/// Returns: 0, FIXPAIR_ERROR_NULL if parallel_for is null, FIXPAIR_ERROR_HOOK if it does not keep its contract
///
/// # Safety
/// `exec` is null or points to a hook whose functions can be called.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_exec_self_test(exec: *const fixpair_exec) -> fixpair_status_t {
    const LONGEST: usize = 1000;
    code((|| {
        // SAFETY: the caller's promise.
        let exec = unsafe { HostExec::new(&mut Border::new(), exec) }?;
        for count in [0, 1, 2, 3, 64, LONGEST] {
            let calls = [const { AtomicUsize::new(0) }; LONGEST];
            exec.parallel_for(count, &|i| {
                if let Some(calls) = calls.get(i) {
                    calls.fetch_add(1, Ordering::Relaxed);
                }
            })?;
            if calls.iter().take(count).any(|calls| calls.load(Ordering::Relaxed) != 1) {
                return Err(Error::Hook);
            }
        }
        Ok(())
    })())
}

/// The built-in pool of threads; opaque.
#[cfg(feature = "std")]
pub struct fixpair_threads {
    pool: crate::exec::Threads,
}

#[cfg(feature = "std")]
unsafe extern "C" fn pool_for(
    context: *mut c_void,
    count: usize,
    body: unsafe extern "C" fn(argument: *mut c_void, index: usize),
    argument: *mut c_void,
) -> i32 {
    struct Argument(*mut c_void);
    // SAFETY: the kernels' argument may be used from any thread.
    unsafe impl Sync for Argument {}
    impl Argument {
        // A method, so that the closure borrows the whole and not the bare pointer.
        fn get(&self) -> *mut c_void {
            self.0
        }
    }
    let argument = Argument(argument);
    // SAFETY: `context` is the pool that `fixpair_threads_create` put there.
    let threads = unsafe { &*context.cast_const().cast::<fixpair_threads>() };
    // SAFETY: the body is the kernel's, called with its own argument.
    let run = threads.pool.parallel_for(count, &|i| unsafe { body(argument.get(), i) });
    run.map_or(1, |()| 0)
}

/// Starts a pool of threads, for hosts without one. The calling thread counts as one of them and works too. The threads sleep between
/// kernels. Several threads may use one pool; a kernel that finds it busy runs alone. This is the only function that
/// starts threads, and but for faer (rule 1) the only one that takes memory from the heap. A library built without the feature "std" lacks it: there
/// define FIXPAIR_NO_THREADS before this header is included.
///
/// Out: threads  the pool; give it back to fixpair_threads_destroy
///      exec     a hook that runs loops on it, valid until then
/// In:  count    threads, 1 to 4096
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_RANGE, FIXPAIR_ERROR_THREAD
///
/// # Safety
/// Both pointers are null or point to one value.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_threads_create(
    threads: *mut *mut fixpair_threads,
    exec: *mut fixpair_exec,
    count: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (threads, exec) = unsafe { (border.write_one(threads)?, border.write_one(exec)?) };
        let pool = std::boxed::Box::new(fixpair_threads { pool: crate::exec::Threads::new(count)? });
        *threads = std::boxed::Box::into_raw(pool);
        *exec = fixpair_exec { context: (*threads).cast(), parallel_for: Some(pool_for) };
        Ok(())
    })())
}

/// Stops the threads of a pool and frees it. NULL does nothing.
///
/// In:  threads  from fixpair_threads_create, with no kernel running on it
///
/// # Safety
/// `threads` is null or a pool that was not destroyed before.
#[cfg(feature = "std")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_threads_destroy(threads: *mut fixpair_threads) {
    if !threads.is_null() {
        // SAFETY: it came from `Box::into_raw` in `fixpair_threads_create`.
        drop(unsafe { std::boxed::Box::from_raw(threads) });
    }
}
