//! The code of pages: that of `docs/adding-fixpair-to-your-code.md` compiles where the page puts it, that of
//! `docs/verify-your-png-ics.md` prints what the page says, and so does the program behind a table of `docs/speed-and-memory.md`.

use std::process::Command;

use crate::native::{LIBRARIES, SYSTEM, folder, root, run, shared_library, tool};

const PAGE: &str = "adding-fixpair-to-your-code.md";

/// A page of `docs/`.
pub(crate) fn page(name: &str) -> String {
    std::fs::read_to_string(root().join("docs").join(name)).expect("the page")
}

/// Blocks of one language.
pub(crate) fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    page.split(&format!("```{language}\n")).skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

/// Python that has numpy and the package of `python/` with the shared library; none where a machine need not have numpy.
pub(crate) fn with_numpy() -> Option<Command> {
    let python = || {
        let mut python = tool("PYTHON", "python3");
        python.arg("-B").env("PYTHONPATH", root().join("python")).env("FIXPAIR_LIBRARY", shared_library());
        python
    };
    let tried = python().args(["-c", "import numpy, fixpair"]).output();
    if tried.is_ok_and(|output| output.status.success()) {
        return Some(python());
    }
    assert!(
        std::env::var_os("FIXPAIR_REQUIRE_NUMPY").is_none(),
        "python3 (or PYTHON) lacks numpy, or cannot import python/fixpair"
    );
    println!("skipped: no numpy for python3 (or PYTHON)");
    None
}

/// Compiles, but does not link, a source of this name in which a program has put blocks.
fn compiles(variable: &str, compiler: &str, options: &[&str], name: &str, source: &str) {
    let file = folder().join(name);
    std::fs::write(&file, source).expect("the target folder can be written");
    let mut compile = tool(variable, compiler);
    compile.args(options).args(["-Wall", "-Wextra", "-Werror", "-Wno-sign-compare", "-Wno-unused-function"]);
    run(compile.args(["-fsyntax-only", "-I"]).arg(root().join("include")).arg(file));
}

/// What 2LPTic and N-GenIC have at hand in `displacement_fields`, of their names and types.
const GENERATOR: &str = "
extern int Nmesh, Nsample, Local_nx, Local_x_start, SphereMode, FixedAmplitude, PhaseFlip, Seed;
extern long TotalSizePlusAdditional;
extern double Box, Dplus, PI;
double PowerSpec(double k);
int FatalError(int number);
typedef struct { REAL re, im; } fftw_complex;
extern REAL *Disp;
extern fftw_complex *Cdata;
";

#[test]
fn patches_in_c_compile() {
    let page = page(PAGE);
    let found = blocks(&page, "c");
    assert_eq!(found.len(), 3, "2LPTic, N-GenIC, f_NL");
    for (i, real) in ["double", "float"].into_iter().enumerate() {
        assert!(found[i].lines().count() < 30, "less than 30 lines");
        let (includes, code): (Vec<_>, Vec<_>) =
            found[i].lines().partition(|line| line.starts_with("#include"));
        let (includes, code) = (includes.join("\n"), code.join("\n"));
        let source = format!(
            "#include <math.h>\n#include <stdint.h>\n#include <stdlib.h>\n{includes}\n#define REAL {real}\n{GENERATOR}
             void displacement_fields(REAL **disp, fftw_complex **cdisp);
             void displacement_fields(REAL **disp, fftw_complex **cdisp)\n{{
             int64_t i, k = 0; int axes; double fac = pow(2 * PI / Box, 1.5), kvec[3], kmag2;
             (void)disp; (void)cdisp; (void)k;\n{code}\n}}\n"
        );
        compiles("CC", "cc", &["-std=c11"], &format!("patch{i}.c"), &source);
    }
    compiles(
        "CC",
        "cc",
        &["-std=c99", "-pedantic"],
        "patch_png.c",
        &format!("#include <fixpair.h>\n{}", found[2]),
    );
}

#[test]
fn patches_in_cpp_compile() {
    let required = std::env::var_os("FIXPAIR_REQUIRE_CXX").is_some();
    if !required && tool("CXX", "c++").arg("--version").output().is_err() {
        println!("skipped: no C++ compiler (c++ or CXX)");
        return;
    }
    let page = page(PAGE);
    let found = blocks(&page, "cpp");
    assert_eq!(found.len(), 1, "Gadget-4");
    assert!(found[0].lines().count() < 30, "less than 30 lines");
    let source = format!(
        "#include <cmath>\n#include <cstring>\n#include <vector>\n#include <fixpair.h>\n
         #define NGENIC 256\n#define Terminate(...) throw fixpair_status_t(-1)\n
         typedef float fft_real, fft_complex[2];
         extern struct all {{ double BoxSize; int NgenicSeed, SphereMode, NSample; }} All;
         struct ngenic {{ size_t maxfftsize; double Dplus; struct {{ int slabstart_y, nslab_y; }} myplan;
         double ngenic_power_spec(double k); void ngenic_setup_modes_in_kspace(fft_complex *fft_of_grid); }};
         void ngenic::ngenic_setup_modes_in_kspace(fft_complex *fft_of_grid)\n{{\n{}\n}}\n",
        found[0]
    );
    compiles("CXX", "c++", &["-std=c++11"], "patch.cpp", &source);
}

/// The program, which the examples compile and run, has the lines of the page.
#[test]
fn the_fortran_of_the_page_is_that_of_the_example() {
    let page = page(PAGE);
    let found = blocks(&page, "fortran");
    let example = root().join("c-examples/fortran/initial_conditions.f90");
    let example = std::fs::read_to_string(example).expect("the example");
    assert_eq!(found.len(), 1, "one block");
    assert!(found[0].lines().count() < 30, "less than 30 lines");
    assert!(example.contains(found[0]), "the block stands in initial_conditions.f90 as it is");
}

#[test]
fn the_python_of_the_verdict_prints_what_the_page_says() {
    let Some(mut python) = with_numpy() else { return };
    let page = page("verify-your-png-ics.md");
    let (found, text) = (blocks(&page, "python"), blocks(&page, "text"));
    assert_eq!(found.len(), 1, "one program");
    let output = run(python.args(["-c", found[0]]));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains(&printed.as_str()), "the page has not:\n{printed}");
}

#[test]
fn the_table_of_memory_is_what_the_library_asks_for() {
    let program = folder().join("print_memory");
    let mut compile = tool("CC", "cc");
    compile.args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-I"]).arg(root().join("include"));
    compile.arg(root().join("c-examples/print_memory.c")).arg("-o").arg(&program);
    run(compile.arg(LIBRARIES.join("libfixpair.a")).args(SYSTEM));
    let output = run(&mut Command::new(program));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(page("speed-and-memory.md").contains(&table), "the page has not:\n{table}");
}
