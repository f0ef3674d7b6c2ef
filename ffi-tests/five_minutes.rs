//! `docs/five-minutes.md`: its programs compile as they stand, run, and print the numbers of the page.

use std::path::Path;
use std::process::Command;

use crate::native::{LIBRARIES, SYSTEM, folder, root, run, tool};
use crate::pages::{blocks, page, with_numpy};

/// The Rust of the page, which is an example too, with a `main` that is not called here.
#[expect(dead_code)]
#[path = "../examples/five_minutes.rs"]
mod in_rust;

const PAGE: &str = "five-minutes.md";

/// The only block of a language, as a file.
fn source(language: &str, name: &str) -> std::path::PathBuf {
    let page = page(PAGE);
    let found = blocks(&page, language);
    assert_eq!(found.len(), 1, "one program in {language}");
    let file = folder().join(name);
    std::fs::write(&file, found[0]).expect("the target folder can be written");
    file
}

/// Rows of numbers.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split_whitespace().map(|word| word.parse().expect(line)).collect();
    text.lines().filter(|line| !line.trim().is_empty()).map(row).collect()
}

/// What a program prints is what the page says, digit for digit but for leading blanks.
fn prints_the_table(program: &mut Command) {
    let output = run(program);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let page = page(PAGE);
    let table = blocks(&page, "text");
    assert_eq!(table.len(), 1, "one table");
    let (printed, table) = (numbers(&printed), numbers(table[0]));
    assert_eq!(printed.len(), table.len(), "shells");
    for (printed, row) in printed.iter().flatten().zip(table.iter().flatten()) {
        // Six decimals; processors and transforms agree to rounding, which may turn the last one.
        assert!((printed - row).abs() < 1.5e-6, "{printed} is printed where the page has {row}");
    }
}

/// Compiles a source with the static library and runs it.
fn compiled(variable: &str, default: &str, options: &[&str], sources: &[&Path], name: &str) {
    let program = folder().join(name);
    let mut compile = tool(variable, default);
    compile.args(options).args(["-O1", "-Wall", "-Wextra", "-Werror", "-I"]).arg(root().join("include"));
    compile.args(sources).arg("-o").arg(&program).arg(LIBRARIES.join("libfixpair.a")).args(SYSTEM);
    run(&mut compile);
    prints_the_table(&mut Command::new(program));
}

/// Is this tool here? One that the environment requires must be.
fn is_here(variable: &str, default: &str, requirement: &str) -> bool {
    let here = tool(variable, default).arg("--version").output().is_ok();
    assert!(here || std::env::var_os(requirement).is_none(), "{default} is missing");
    if !here {
        println!("skipped: no {default} (or {variable})");
    }
    here
}

#[test]
fn the_c_of_five_minutes_prints_the_table() {
    compiled("CC", "cc", &["-std=c11"], &[&source("c", "five_minutes.c")], "five_minutes_c");
}

#[test]
fn the_cpp_of_five_minutes_prints_the_table() {
    if is_here("CXX", "c++", "FIXPAIR_REQUIRE_CXX") {
        compiled("CXX", "c++", &["-std=c++17"], &[&source("cpp", "five_minutes.cpp")], "five_minutes_cpp");
    }
}

#[test]
fn the_fortran_of_five_minutes_prints_the_table() {
    if is_here("FC", "gfortran", "FIXPAIR_REQUIRE_FORTRAN") {
        let module = root().join("c-examples/fortran/fixpair.f90");
        let modules = format!("-J{}", folder().display());
        let sources: [&Path; 2] = [&module, &source("fortran", "five_minutes.f90")];
        compiled("FC", "gfortran", &["-std=f2018", &modules], &sources, "five_minutes_fortran");
    }
}

#[test]
fn the_python_of_five_minutes_prints_the_table() {
    if let Some(mut python) = with_numpy() {
        prints_the_table(python.arg(source("python", "five_minutes.py")));
    }
}

#[test]
fn the_rust_of_five_minutes_prints_the_table() {
    let example = include_str!("../examples/five_minutes.rs");
    let page = page(PAGE);
    assert_eq!(blocks(&page, "rust"), [example], "the block is examples/five_minutes.rs");
    let table = blocks(&page, "text");
    assert_eq!(numbers(&in_rust::table().expect("the program")), numbers(table[0]));
}
