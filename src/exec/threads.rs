//! The built-in pool: threads that sleep until a kernel has chunks for them.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::JoinHandle;
use std::vec::Vec;

use super::{Exec, Serial};
use crate::status::{Error, Result};

type Body = dyn Fn(usize) + Sync;

/// A pool of threads, counting the one that calls the kernel. Several threads may use one pool; whoever finds it busy
/// (or calls it from inside a chunk) runs its chunks alone.
pub struct Threads {
    inner: Arc<Inner>,
    busy: Mutex<()>,
    workers: Vec<JoinHandle<()>>,
}

struct Inner {
    state: Mutex<State>,
    work: Condvar,
    done: Condvar,
    next: AtomicUsize,
}

struct State {
    job: Option<Job>,
    epoch: u64,
    running: usize,
    panicked: bool,
    stop: bool,
}

/// The lifetime of `body` is erased: `parallel_for` does not return while a worker holds it.
#[derive(Clone, Copy)]
struct Job {
    body: *const Body,
    count: usize,
}

// SAFETY: the body is Sync, and alive while any worker may call it.
unsafe impl Send for Job {}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Threads {
    /// Starts `threads - 1` threads, and returns when all of them run.
    ///
    /// # Errors
    /// `Range` if `threads` is 0 or above 4096, `Thread` if the system refuses one.
    ///
    /// # Example
    /// ```
    /// use fixpair::exec::{Threads, for_each_piece};
    ///
    /// let pool = Threads::new(2)?; // the calling thread is one of them
    /// let mut data = [0; 10];
    /// for_each_piece(&pool, &mut data, 4, &|piece, values| values.fill(piece))?;
    /// assert_eq!(data, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(threads: usize) -> Result<Self> {
        if threads == 0 || threads > 4096 {
            return Err(Error::Range);
        }
        let state = State { job: None, epoch: 0, running: 0, panicked: false, stop: false };
        let inner = Arc::new(Inner {
            state: Mutex::new(state),
            work: Condvar::new(),
            done: Condvar::new(),
            next: AtomicUsize::new(0),
        });
        let mut pool = Self { inner, busy: Mutex::new(()), workers: Vec::with_capacity(threads - 1) };
        for _ in 1..threads {
            let inner = Arc::clone(&pool.inner);
            let name = std::string::String::from("fixpair");
            let spawned = std::thread::Builder::new().name(name).spawn(move || inner.serve());
            pool.workers.push(spawned.map_err(|_| Error::Thread)?);
        }
        // A new thread takes memory for itself. After this loop all of them have: none does so in the middle of a kernel.
        pool.parallel_for(threads, &|_| ())?;
        Ok(pool)
    }

    /// Threads that run chunks, the caller's included.
    ///
    /// ```
    /// use fixpair::exec::Threads;
    ///
    /// assert_eq!(Threads::new(2)?.threads(), 2);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn threads(&self) -> usize {
        self.workers.len() + 1
    }
}

impl Inner {
    fn serve(&self) {
        let mut seen = 0;
        loop {
            let mut state = lock(&self.state);
            while state.epoch == seen && !state.stop {
                state = self.work.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            if state.stop {
                return;
            }
            seen = state.epoch;
            let job = state.job;
            drop(state);
            let panicked = job.is_some_and(|job| {
                // SAFETY: `parallel_for` waits for this worker before the body's lifetime ends.
                let body = unsafe { &*job.body };
                catch_unwind(AssertUnwindSafe(|| self.drain(job.count, body))).is_err()
            });
            let mut state = lock(&self.state);
            state.panicked |= panicked;
            state.running -= 1;
            if state.running == 0 {
                self.done.notify_one();
            }
        }
    }

    fn drain(&self, count: usize, body: &(dyn Fn(usize) + Sync)) {
        loop {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return;
            }
            body(i);
        }
    }
}

// SAFETY: `next` gives each index to one thread, and the caller waits until every worker has checked out.
unsafe impl Exec for Threads {
    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> Result<()> {
        let _busy = match self.busy.try_lock() {
            Ok(busy) => busy,
            // A chunk panicked once; all workers had checked out before the caller learnt of it.
            Err(TryLockError::Poisoned(busy)) => busy.into_inner(),
            Err(TryLockError::WouldBlock) => return Serial.parallel_for(count, body),
        };
        if self.workers.is_empty() || count < 2 {
            return Serial.parallel_for(count, body);
        }
        // SAFETY: only the lifetime changes; the wait below outlasts every use.
        let erased = unsafe { core::mem::transmute::<&(dyn Fn(usize) + Sync), &'static Body>(body) };
        self.inner.next.store(0, Ordering::Relaxed);
        {
            let mut state = lock(&self.inner.state);
            state.job = Some(Job { body: erased, count });
            state.epoch += 1;
            state.running = self.workers.len();
        }
        self.inner.work.notify_all();
        let mine = catch_unwind(AssertUnwindSafe(|| self.inner.drain(count, body)));
        let mut state = lock(&self.inner.state);
        while state.running > 0 {
            state = self.inner.done.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.job = None;
        let panicked = core::mem::take(&mut state.panicked);
        drop(state);
        if let Err(payload) = mine {
            resume_unwind(payload);
        }
        assert!(!panicked, "a chunk panicked on a pool thread");
        Ok(())
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        lock(&self.inner.state).stop = true;
        self.inner.work.notify_all();
        for worker in self.workers.drain(..) {
            // A worker catches the panics of its chunks, so joining cannot fail for a reason worth raising in drop.
            let _ = worker.join();
        }
    }
}
