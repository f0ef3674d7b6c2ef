//! The library where there is nothing: no C library, no allocator, and no way to panic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::abi::kernels;
use crate::native::{FREESTANDING, Language, attempt, compiler, folder, run};

/// Undefined symbols of an object or archive, without the underscore that some platforms put before them.
pub(crate) fn undefined(file: &Path) -> BTreeSet<String> {
    let output = run(Command::new("nm").arg("-u").arg(file));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let symbols = text.lines().filter_map(|line| line.split_whitespace().last());
    symbols.map(|symbol| symbol.trim_start_matches('_').to_owned()).collect()
}

/// Where the panic handler goes, which is nowhere.
const PANIC: &str = "fixpair_panic_is_reachable";

/// Links `freestanding.c` with the library, and with references to `functions` beside those that it calls.
fn link(name: &str, functions: &BTreeSet<String>) -> (PathBuf, Command) {
    let mut source =
        String::from("#define FIXPAIR_NO_THREADS\n#define FIXPAIR_NO_LINALG\n#include <fixpair.h>\n");
    source.push_str(
        "typedef void (*function)(void);\nextern const function kernels[];\nconst function kernels[] = {\n",
    );
    for function in functions {
        source.push_str(&format!("(function){function},\n"));
    }
    source.push_str("0};\n");
    let table = folder().join(name).with_extension("c");
    std::fs::write(&table, source).expect("the target folder can be written");
    let program = folder().join(name);
    let mut command = compiler(Language::C, "freestanding.c");
    command.arg(table).args([
        "-ffreestanding",
        "-fno-builtin",
        "-fno-stack-protector",
        "-nostdlib",
        "-static",
        "-no-pie",
    ]);
    // What no kernel needs does not count: of the archive only sections that something refers to are linked.
    command.args(["-Wl,--gc-sections", "-Wl,-u,kernels"]);
    command.arg(FREESTANDING.join("libfixpair.a")).arg("-o").arg(&program);
    (program, command)
}

/// The library without std asks for nothing but copies of memory, and a program without a C library that refers to every function
/// links: no input of any of them reaches a panic.
#[test]
#[cfg_attr(
    not(all(target_os = "linux", target_arch = "x86_64")),
    ignore = "its start and exit are those of Linux on x86-64"
)]
fn every_kernel_links_without_panic_and_malloc() {
    let library = FREESTANDING.join("libfixpair.a");
    let wanted = undefined(&library);
    assert!(wanted.contains(PANIC), "a panic would be noticed");
    let forbidden =
        ["malloc", "calloc", "realloc", "free", "posix_memalign", "aligned_alloc", "abort", "exit", "mmap"];
    for symbol in &wanted {
        assert!(
            !forbidden.contains(&symbol.as_str()) && !symbol.starts_with("pthread"),
            "the freestanding library needs {symbol}"
        );
    }
    let kernels = kernels();
    let (program, mut command) = link("freestanding_program", &kernels);
    let output = attempt(&mut command);
    if !output.status.success() {
        let one = |name: &&String| {
            let (_, mut command) = link("freestanding_kernel", &BTreeSet::from([(*name).clone()]));
            !attempt(&mut command).status.success()
        };
        let guilty: Vec<_> = kernels.iter().filter(one).collect();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        panic!("a panic is reachable from {guilty:?}, or they do not link:\n{message}");
    }
    let left = undefined(&program);
    assert!(left.is_empty(), "still undefined: {left:?}");
    run(&mut Command::new(program));
}
