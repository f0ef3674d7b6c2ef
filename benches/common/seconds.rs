//! Time of the processor.

use std::time::Instant;

/// Seconds that this thread has spent on a processor, where the system tells: others use this machine too.
fn now() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

/// Seconds of a run.
pub(crate) fn seconds(run: impl FnOnce()) -> f64 {
    let (start, before) = (Instant::now(), now());
    run();
    match (before, now()) {
        (Some(before), Some(after)) => after - before,
        _ => start.elapsed().as_secs_f64(),
    }
}
