"""Structures with constructors that take members by name, and that keep the arrays which they point into."""

from typing import Any

from .native import Structure


class Members:
    """Before a structure of :mod:`fixpair.native`: sets members, and keeps what pointers refer to alive.

    ``_pointers`` names members that are given as arrays; the method ``_point`` of a class checks them. ``_lengths`` names those that
    follow from the arrays, and that nobody else may set: the library would read beyond an array.
    """

    _pointers: tuple[str, ...] = ()
    _lengths: tuple[str, ...] = ()

    def _set(self, members: dict[str, Any]) -> None:
        for name, value in members.items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self._lengths:
            raise AttributeError(f"{name} follows from the arrays that {type(self).__name__} was given")
        if name in self._pointers:
            value, kept = self._point(name, value)
            self.__dict__[f"_kept_{name}"] = kept
        elif isinstance(value, Structure):
            # A structure is copied into this one; its arrays must live as long.
            self.__dict__[f"_kept_{name}"] = dict(value.__dict__)
        super().__setattr__(name, value)

    def _count(self, name: str, length: int) -> None:
        """Sets a member that follows from an array."""
        super().__setattr__(name, length)

    def _point(self, name: str, value: Any) -> tuple[Any, Any]:
        """The address that a member takes, and what keeps it valid."""
        raise NotImplementedError
