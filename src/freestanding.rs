//! What a static library needs where there is neither std nor an operating system: somewhere to go on a panic.
//!
//! The symbol that it goes to is defined nowhere. A program links only while the compiler has proved of every function it calls that no input
//! reaches a panic.

unsafe extern "C" {
    /// Defined nowhere.
    fn fixpair_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: never executed, for what calls it does not link.
    unsafe { fixpair_panic_is_reachable() }
}
