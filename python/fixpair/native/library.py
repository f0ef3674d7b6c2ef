"""The shared library, with functions that raise what their status says."""

import ctypes
import functools
from typing import TYPE_CHECKING, Any
from collections.abc import Callable

from .errors import error_of
from .prototypes import LETTERS, OTHERS, SIGNATURES


def address(argument):
    """What a pointer argument becomes: structures and arrays are passed by reference."""
    if isinstance(argument, (ctypes.Structure, ctypes.Array, ctypes._SimpleCData)):
        return ctypes.addressof(argument)
    interface = getattr(argument, "__array_interface__", None)
    if interface is None:
        return argument
    # Scalars of numpy have an address too, but stand for their value.
    return interface["data"][0] if interface["shape"] else argument.item()


class Library:
    """The functions of a shared library, without their prefix.

    Those that return a status raise its :class:`FixpairError` and return nothing; outputs are pointers, as in C.
    """

    def __init__(self, path):
        self.shared = ctypes.CDLL(path)
        for name, (result, signature) in OTHERS.items():
            self._bind(name, result, signature, self._plain)
        for name, signature in SIGNATURES.items():
            self._bind(name, ctypes.c_int32, signature, self._checked)

    if TYPE_CHECKING:
        # Type checkers do not see what the constructor binds.
        def __getattr__(self, name: str) -> Callable[..., Any]: ...

    def _bind(self, name, result, signature, call):
        function = getattr(self.shared, "fixpair_" + name)
        function.restype, function.argtypes = result, [LETTERS[letter] for letter in signature]
        setattr(self, name, functools.partial(call, name, function))

    def called(self, name, arguments):
        """Hears of each call that did what it should, for those who keep records."""

    def _plain(self, name, function, *arguments):
        result = function(*arguments)
        self.called(name, arguments)
        return result

    def _checked(self, name, function, *arguments):
        status = function(*map(address, arguments))
        if status != 0:
            raise error_of(status, self.status_message(status).decode(), name)
        self.called(name, arguments)
