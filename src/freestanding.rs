//! What a static library needs where there is neither std nor an operating system: somewhere to go on a panic.
//!
//! No input reaches a panic; the linker wants the symbol all the same.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
