//! Runs the programs. Each prints what does not hold and fails, and the test shows it.

use std::process::Command;

use crate::native::{Language, program, run};
use crate::vectors::VECTORS;

#[test]
fn c_gets_the_bits_of_rust() {
    let program = program(Language::C, "conformance.c", "conformance", &["-pthread"]);
    run(Command::new(program).arg(&*VECTORS));
}
