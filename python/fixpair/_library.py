"""The shared library that this process uses."""

import os
import sys
from pathlib import Path

from . import native

SUFFIXES = {"darwin": ".dylib", "win32": ".dll"}


def path() -> Path:
    """The library that FIXPAIR_LIBRARY names, or the one that was built with the package."""
    named = os.environ.get("FIXPAIR_LIBRARY")
    if named:
        return Path(named)
    prefix = "" if sys.platform == "win32" else "lib"
    bundled = Path(__file__).parent / f"{prefix}fixpair{SUFFIXES.get(sys.platform, '.so')}"
    if not bundled.exists():
        raise ImportError(f"{bundled} is missing. `pip install` builds it; in a source tree let FIXPAIR_LIBRARY name a shared library "
                          "that `cargo rustc --release --lib --crate-type cdylib` has made")
    return bundled


library = native.Library(str(path()))


def twin(name: str, real: str):
    """The function of one precision."""
    return getattr(library, f"{name}_{real}")


def version() -> str:
    """The version of the library that runs, as major.minor.patch."""
    return library.version().decode()


def status_message(status: int) -> str:
    """One sentence about a status: what is wrong and what to do."""
    return library.status_message(status).decode()
