"""Builds the shared library with cargo, from the crate one folder up, and bundles it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
CRATE = HERE.parent / "Cargo.toml"
NAME = {"darwin": "libfixpair.dylib", "win32": "fixpair.dll"}.get(sys.platform, "libfixpair.so")


def version() -> str:
    """That of the crate; in a source distribution, which has no crate beside it, the one that it was made with."""
    if CRATE.exists():
        return re.search(r'^version = "(.+)"$', CRATE.read_text(encoding="utf-8"), re.M).group(1)
    return re.search(r"^Version: (.+)$", (HERE / "PKG-INFO").read_text(encoding="utf-8"), re.M).group(1)


def shared_library() -> Path:
    """The library that FIXPAIR_LIBRARY names, or one that cargo builds."""
    named = os.environ.get("FIXPAIR_LIBRARY")
    if named:
        if not Path(named).is_file():
            sys.exit(f"FIXPAIR_LIBRARY names {named}, which is no file")
        return Path(named)
    if not CRATE.exists():
        sys.exit("The crate fixpair is not beside this folder: let FIXPAIR_LIBRARY name a shared library that "
                 "`cargo rustc --release --lib --crate-type cdylib` has made, or install from the repository")
    cargo = os.environ.get("CARGO") or shutil.which("cargo")
    if cargo is None:
        sys.exit("cargo was not found: install Rust (https://rustup.rs), or let FIXPAIR_LIBRARY name a shared library")
    target = Path(os.environ.get("CARGO_TARGET_DIR", CRATE.parent / "target"))
    # Both kinds, as the examples in C ask for: cargo then has nothing to build where those were built.
    command = [cargo, "rustc", "--manifest-path", CRATE, "--target-dir", target, "--release", "--locked", "--lib",
               "--crate-type", "staticlib,cdylib"]
    if subprocess.run(command, check=False).returncode != 0:
        sys.exit(f"cargo could not build the library: {' '.join(map(str, command))}")
    return target / "release" / NAME


class BuildWithLibrary(build_py):
    """The modules, and the library beside them."""

    def run(self):
        super().run()
        folder = HERE / "fixpair" if self.editable_mode else Path(self.build_lib) / "fixpair"
        shutil.copy(shared_library(), folder / NAME)


class PlatformDistribution(Distribution):
    """Belongs where compiled packages are, though the compiled part is no module."""

    def has_ext_modules(self):
        return True


class PlatformWheel(bdist_wheel):
    """For any Python 3 of one platform: the library does not know Python."""

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


for licence in CRATE.parent.glob("LICENSE-*") if CRATE.exists() else ():
    # Those of the crate travel with what is distributed.
    shutil.copy(licence, HERE)

setup(version=version(), distclass=PlatformDistribution, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": PlatformWheel})
