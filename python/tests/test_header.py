"""The low-level layer is fixpair.h: the same constants, structures and prototypes."""

import ctypes
import re
from enum import Enum
from pathlib import Path

import pytest

from fixpair import native

HEADER = Path(__file__).resolve().parents[2] / "include" / "fixpair.h"
TEXT = re.sub(r"/\*.*?\*/", "", HEADER.read_text(encoding="utf-8"), flags=re.S)

CHOICES = {
    "EVENT": native.Event, "ERROR": native.Status, "SPACE": native.Space, "SCHEME": native.Scheme,
    "AMPLITUDE": native.Amplitude, "PHASE": native.Phase, "NYQUIST": native.Nyquist, "SELECTION": native.Selection,
    "CONVENTION": native.Convention, "LINEAR": native.LinearSource, "NORMALISE": native.Normalisation, "RATIO": native.Ratio,
    "ORDER": native.Order, "SHAPE": native.Shape, "WINDOW": native.Window, "DIFFERENCE": native.Difference,
    "STEPPER": native.Stepper, "OVERDENSITY": native.OverdensityDefinition, "SECOND": native.Second,
    "COMPENSATION": native.Compensation, "MOMENTS": native.Moments, "SPECTRUM": native.Spectrum, "FREE": native.Free,
    "BETA": native.Beta, "MULTIPOLE": native.Multipole,
}
POLES = ("MONOPOLE", "DIPOLE", "QUADRUPOLE", "OCTUPOLE", "HEXADECAPOLE")
SCALARS = {"size_t": "n", "double": "d", "int32_t": "i", "uint32_t": "w", "uint64_t": "u", "fixpair_status_t": "i"}
RENAMED = {"difference": "DifferenceOfMatched"}


def test_constants_are_those_of_the_header():
    defined = dict(re.findall(r"#define FIXPAIR_(\w+) \(?(-?[\d.]+)\)?", TEXT))
    assert float(defined.pop("COLA_EXPONENT")) == native.COLA_EXPONENT
    assert int(defined.pop("BISPECTRUM_WORDS")) == native.BISPECTRUM_WORDS
    assert int(defined.pop("OK")) == native.Status.OK
    found = {}
    for prefix, kind in CHOICES.items():
        assert issubclass(kind, Enum)
        for member in kind:
            name = str(POLES.index(member.name)) if prefix == "MULTIPOLE" else member.name
            found[f"{prefix}_{name}"] = str(member.value)
    del found["ERROR_OK"]
    assert found == defined


def flattened(kind):
    """Scalars of a structure in order, arrays by their length."""
    if issubclass(kind, ctypes.Array):
        return flattened(kind._type_) * kind._length_
    if issubclass(kind, ctypes.Structure):
        return [each for _, member in kind._fields_ for each in flattened(member)]
    return [ctypes.c_void_p if issubclass(kind, ctypes._CFuncPtr) else kind]


def structures():
    """Members of each structure of the header: name, type, length."""
    found = {}
    for body, name in re.findall(r"typedef struct fixpair_\w+ \{(.*?)\} fixpair_(\w+);", TEXT, re.S):
        members = []
        for declaration in re.sub(r"\s+", " ", body).split(";"):
            declaration = declaration.strip()
            hook = re.match(r"\w+ \(\*(\w+)\)", declaration)
            if hook:
                members.append((hook.group(1), "p", 1))
            elif declaration:
                kind, pointer, member, sizes = re.match(r"(?:const )?(?:struct )?(\w+) (\**)(\w+)((?:\[\d+\])*)$", declaration).groups()
                length = 1
                for size in re.findall(r"\d+", sizes):
                    length *= int(size)
                members.append((member, "p" if pointer else kind, length))
        found[name] = members
    return found


STRUCTURES = structures()


def python_name(name):
    plain = re.sub(r"_f(32|64)$", "", name)
    return RENAMED.get(plain, plain.title().replace("_", ""))


def expected(name):
    scalars = []
    for _, kind, length in STRUCTURES[name]:
        if kind == "p" or kind in SCALARS:
            scalars += [native.LETTERS[SCALARS.get(kind, "p")]] * length
        else:
            scalars += expected(kind.removeprefix("fixpair_")) * length
    return scalars


@pytest.mark.parametrize("name", STRUCTURES)
def test_structures_have_the_members_of_the_header(name):
    kind = getattr(native, python_name(name))
    assert [member for member, _ in kind._fields_] == [member for member, _, _ in STRUCTURES[name]]
    assert flattened(kind) == expected(name)


def test_every_structure_is_there():
    assert len(STRUCTURES) > 30


def test_prototypes_are_those_of_the_header():
    declared, others = {}, {}
    results = {"const char *": ctypes.c_char_p, "void ": None, "size_t ": ctypes.c_size_t}
    for result, name, arguments in re.findall(r"^(\w[\w ]*[ *])fixpair_(\w+)\(([^;{}]*?)\);", TEXT, re.M):
        letters = ""
        for argument in re.split(r",\s*", arguments):
            if argument != "void":
                letters += "p" if "*" in argument else SCALARS[argument.split()[0]]
        if result == "fixpair_status_t ":
            declared[name] = letters
        else:
            others[name] = (results[result], letters)
    assert len(declared) > 200
    assert native.SIGNATURES == declared
    assert native.OTHERS == others
