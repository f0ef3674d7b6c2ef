#!/usr/bin/env python3
"""Proves that one seed is one universe, bit for bit: python3 ffi-tests/bits/bits.py

Builds the library as it ships, for any x86-64, and once more for x86-64-v3; runs bits.c on 1, 2 and 5 threads, on whole meshes, slabs, transposed
slabs and pencils, twice, and on a processor without AVX2 (which qemu-x86_64 plays); compares all with each other and with golden.txt, prints a
table, and fails where a promise does not hold. docs/determinism.md says what is promised.

FIXPAIR_BLESS=1 writes golden.txt anew. A change there is a change of the universes that seeds stand for: CHANGELOG.md has to call it breaking.
REQUIRE_QEMU=1 fails where qemu-x86_64 is missing. CC, CARGO and CARGO_TARGET_DIR are the usual ones.
"""

import os
import pathlib
import platform
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
GOLDEN = HERE / "golden.txt"
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
# Differences of what went through transforms, over the r.m.s. or the side of the box.
EPSILON = {"f32": 2.0**-23, "f64": 2.0**-52}
# In epsilons: a transform and what is made with a few of them; five steps of a run, in which differences grow.
ROUNDING = {"fft": 32, "initial": 32, "evolve": 256, "evolved": 256}

failures = []


def run(command, **options):
    return subprocess.run([str(word) for word in command], check=True, **options)


def library(target, flags, kinds, *options):
    """The static library, with the release profile and no flags but these."""
    environment = {key: value for key, value in os.environ.items() if key not in ("RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS")}
    if flags:
        environment["RUSTFLAGS"] = flags
    cargo = os.environ.get("CARGO", "cargo")
    command = [cargo, "rustc", "--locked", "--quiet", "--release", "--lib", "--crate-type", kinds, "--target-dir", target, *options]
    run(command, cwd=ROOT, env=environment)
    return target / "release" / "libfixpair.a"


def program(archive, name):
    folder = TARGET / "bits"
    folder.mkdir(parents=True, exist_ok=True)
    compiler = os.environ.get("CC", "cc").split()
    options = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off", "-I", ROOT / "include"]
    run([*compiler, *options, HERE / "bits.c", "-o", folder / name, archive, "-lpthread", "-ldl", "-lm"])
    return folder / name


def start(command, cut, threads, keep=None):
    words = [*command, cut, threads] + ([TARGET / "bits" / keep] if keep else [])
    return subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, text=True)


def finish(name, process):
    """Lines of a run: name to (promise, hash)."""
    output = process.communicate()[0]
    if process.returncode != 0:
        print(output)
        sys.exit(f"{name}: the program failed with {process.returncode}")
    lines = [line.split() for line in output.splitlines()]
    return {words[1]: (words[0], words[2]) for words in lines if len(words) == 3}


def differences(program_, left, right):
    folder = TARGET / "bits"
    output = run([program_, folder / left, folder / right], stdout=subprocess.PIPE, text=True).stdout
    return {name: float(value) for name, value in (line.split() for line in output.splitlines())}


def precision(name):
    return "f32" if name.endswith(".f32") else "f64"


def agree(title, reference, other, promises=("exact", "transform", "algebra")):
    """Names whose bits are those of the reference, of lines that both have."""
    wrong = [name for name, (promise, bits) in other.items() if promise in promises and reference[name][1] != bits]
    for name in wrong:
        failures.append(f"{title}: {name} has other bits")
    return {name for name in other if reference[name][1] == other[name][1]}


def has_avx2():
    try:
        flags = pathlib.Path("/proc/cpuinfo").read_text().split("flags", 1)[1].splitlines()[0].split()
    except (OSError, IndexError):
        return False
    return "avx2" in flags and "fma" in flags


def read_golden():
    golden = {}
    for line in GOLDEN.read_text().splitlines() if GOLDEN.exists() else []:
        if line and not line.startswith("#"):
            promise, name, *bits = line.split()
            golden[name] = (promise, *bits)
    return golden


def write_golden(avx2, portable):
    head = [
        "# The bits that seeds stand for: promise, name, and the hash with AVX2; where a transform was on the way, the hash without it too.",
        "# FIXPAIR_BLESS=1 python3 ffi-tests/bits/bits.py writes this file. A seed whose bits change is a breaking change in CHANGELOG.md.",
    ]
    lines = []
    for name, (promise, bits) in avx2.items():
        if promise != "algebra":
            both = bits if promise == "exact" else f"{bits} {portable[name][1]}"
            lines.append(f"{promise:9} {name:40} {both}")
    GOLDEN.write_text("\n".join(head + lines) + "\n")


def check_golden(lines, column):
    golden = read_golden()
    for name in sorted(golden.keys() ^ {name for name, (promise, _) in lines.items() if promise != "algebra"}):
        failures.append(f"golden.txt: {name} is in one of golden.txt and the program only")
    same = 0
    for name, (promise, bits) in lines.items():
        if name in golden:
            kept = golden[name][1 if promise == "exact" else column]
            same += kept == bits
            if kept != bits:
                failures.append(f"golden.txt: {name} has other bits")
    return same


def table(reference, columns):
    """A row for each kernel: = for the same bits; else the largest difference, or "other" where it is not known; - where the run says nothing of it."""
    groups = {}
    for name, (promise, _) in reference.items():
        groups.setdefault((promise, name.removesuffix(".f32").removesuffix(".f64").split(".")[0]), []).append(name)
    titles = [title for title, _, _, _ in columns]
    print(f"\n{'promise':10}{'kernel':27}{'lines':>5}  " + "".join(f"{title:>12}" for title in titles))
    for (promise, kernel), names in groups.items():
        row = f"{promise:10}{kernel:27}{len(names):>5}  "
        for _, lines, same, apart in columns:
            told = [name for name in names if name in lines]
            if not told:
                cell = "-"
            elif all(name in same for name in told):
                cell = "="
            elif all(name in apart for name in told if name not in same):
                cell = f"{max(apart[name] for name in told if name not in same):.0e}"
            else:
                cell = "other"
            row += f"{cell:>12}"
        print(row)


def main():
    x86 = platform.machine() in ("x86_64", "AMD64")
    avx2 = x86 and has_avx2()
    qemu = shutil.which("qemu-x86_64") if x86 else None
    if x86 and not qemu and os.environ.get("REQUIRE_QEMU"):
        sys.exit("qemu-x86_64 is missing (qemu-user): it plays the processor without AVX2")
    shipped = program(library(TARGET, "", "staticlib,cdylib"), "bits")
    # Without optimisation across crates: sooner built, and one more thing on which no bit depends.
    apart = ["--config", "profile.release.lto=false", "--config", "profile.release.codegen-units=16"]
    v3 = program(library(TARGET / "v3", "-C target-cpu=x86-64-v3", "staticlib", *apart), "bits_v3") if avx2 else None

    emulated = start([qemu, "-cpu", "Nehalem", shipped], "whole", 2, "portable.values") if qemu else None
    reference = finish("reference", start([shipped], "whole", 1, "reference.values"))
    columns = []

    def column(title, lines, promises=("exact", "transform", "algebra"), keep=None):
        same = agree(title, reference, lines, promises)
        columns.append((title, lines, same, differences(shipped, "reference.values", keep) if keep else {}))

    column("again", finish("again", start([shipped], "whole", 1)))
    for threads in (2, 5):
        column(f"{threads} threads", finish("threads", start([shipped], "whole", threads)))
    for cut, threads in (("slabs", 5), ("transposed", 2), ("pencils", 1)):
        column(cut, finish(cut, start([shipped], cut, threads)))
    if v3:
        # faer chooses its instructions when it is compiled, too.
        column("x86-64-v3", finish("v3", start([v3], "whole", 2, "v3.values")), ("exact", "transform"), "v3.values")
    portable = finish("without AVX2", emulated) if emulated else None
    if portable:
        column("no AVX2", portable, ("exact",), "portable.values")
        for name, apart in columns[-1][3].items():
            if reference[name][0] == "transform" and not apart <= ROUNDING[name.split(".")[0]] * EPSILON[precision(name)]:
                failures.append(f"no AVX2: {name} is {apart:.1e} away, more than rounding")
    table(reference, columns)
    print("\n= the same bits; a number: the largest difference over the r.m.s., or over the side of the box for places; - not promised, and not made")

    if os.environ.get("FIXPAIR_BLESS") and not failures:
        if not (avx2 and portable):
            sys.exit("golden.txt holds bits with and without AVX2: they are written where both can run")
        write_golden(reference, portable)
        print(f"written: {GOLDEN.relative_to(ROOT)}")
    elif x86:
        same = check_golden(reference, 1 if avx2 else 2)
        print(f"golden.txt, {'with' if avx2 else 'without'} AVX2: {same} lines have the bits that they had")
        if portable and avx2:
            print(f"golden.txt, without AVX2: {check_golden(portable, 2)} lines have the bits that they had")
    else:
        same = check_golden({name: line for name, line in reference.items() if line[0] == "exact"}, 1)
        print(f"golden.txt: {same} exact lines have the bits that they had")
    if not qemu:
        print("skipped: a processor without AVX2, for there is no qemu-x86_64 (qemu-user)")
    if not avx2:
        print("skipped: x86-64-v3 and golden bits with AVX2, which this processor does not have")
    if x86:
        print("not shown here: processors that are not x86-64")
    for failure in failures:
        print(f"not so: {failure}")
    print(f"bits: {len(reference)} lines, {len(columns) + 1} runs, {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
