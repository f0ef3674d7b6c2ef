//! No call allocates: conformance.c and refusals.c once more, with a counter around each call and under the allocator.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

use crate::native::{LIBRARIES, Language, SYSTEM, compiler, declared, folder, root, run};
use crate::vectors::VECTORS;

/// A header that replaces each function of fixpair.h by a counted call of it.
fn counted_calls() -> PathBuf {
    let functions = declared();
    let names: Vec<_> = functions.iter().map(|name| format!("\"{name}\"")).collect();
    let mut text = String::from("#include \"allocations.h\"\n");
    let _ = writeln!(text, "#define COUNTED_FUNCTIONS {}", names.join(", "));
    for (number, name) in functions.iter().enumerate() {
        let _ = writeln!(text, "#define {name}(...) COUNTED({number}, {name}(__VA_ARGS__))");
    }
    let header = folder().join("counted_calls.h");
    std::fs::write(&header, text).expect("the target folder can be written");
    header
}

#[test]
#[cfg_attr(
    not(all(target_os = "linux", target_env = "gnu")),
    ignore = "it stands between the program and the allocator of the GNU C library"
)]
fn no_call_allocates() {
    let header = counted_calls();
    let counted = |source: &str| {
        // Thread-local variables came with C11.
        let mut command = compiler(Language::C, source);
        command.args(["-std=c11", "-pthread", "-I"]).arg(folder()).arg("-I").arg(root().join("ffi-tests"));
        command
    };
    let program = folder().join("allocations");
    let mut link = counted("allocations.c");
    for name in ["conformance", "refusals"] {
        let object = folder().join(format!("{name}_counted.o"));
        let mut compile = counted(&format!("{name}.c"));
        // What the program asks of the system's headers, before the first of them.
        compile.args(["-D_POSIX_C_SOURCE=200112L", "-include"]).arg(&header);
        run(compile.arg(format!("-Dmain={name}_main")).arg("-c").arg("-o").arg(&object));
        link.arg(object);
    }
    run(link.arg(LIBRARIES.join("libfixpair.a")).args(SYSTEM).arg("-o").arg(&program));
    let output = run(Command::new(program).arg(&*VECTORS));
    print!("{}", String::from_utf8_lossy(&output.stdout));
}
