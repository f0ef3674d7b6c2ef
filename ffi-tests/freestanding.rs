//! The library where there is nothing: no C library, no allocator, and no way to panic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::abi::kernels;
use crate::native::{FREESTANDING, Language, attempt, compiler, folder, root, run, tool};

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

/// The panic handler of the library in a crate that has a panic: that it does not link is what the next test rests on.
#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the options are those of the GNU linker")]
fn a_panic_that_can_be_reached_does_not_link() {
    let source = folder().join("reachable.rs");
    let handler = root().join("src/freestanding.rs");
    let text = format!(
        "#![no_std]\n#[path = {handler:?}]\nmod freestanding;\n#[unsafe(no_mangle)]\n\
         pub extern \"C\" fn element(values: &[u8; 4], index: usize) -> u8 {{ values[indexMASK] }}\n"
    );
    for (mask, links) in [("", false), (" % 4", true)] {
        std::fs::write(&source, text.replace("MASK", mask)).expect("the target folder can be written");
        let library = folder().join("libreachable.a");
        let mut rustc = tool("RUSTC", "rustc");
        rustc.args(["--edition=2024", "--crate-type=staticlib", "-Cpanic=abort", "-Copt-level=3", "-o"]);
        run(rustc.arg(&library).arg(&source));
        let mut link = tool("CC", "cc");
        link.args(["-nostdlib", "-static", "-Wl,--gc-sections", "-Wl,-u,element", "-Wl,-e,element"]);
        let output = attempt(link.arg(&library).arg("-o").arg(folder().join("reachable")));
        assert_eq!(output.status.success(), links, "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(String::from_utf8_lossy(&output.stderr).contains(PANIC), !links);
    }
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
