"""Everything public says what it is, and what its arguments are."""

import inspect

import pytest

import fixpair

ROOMS = [fixpair.noise, fixpair.cosmology, fixpair.initial, fixpair.pm, fixpair.halos, fixpair.estimate, fixpair.variance, fixpair.fft]


def public():
    for room in ROOMS:
        for name in getattr(room, "__all__", dir(room)):
            thing = getattr(room, name)
            own = getattr(thing, "__module__", "").startswith(room.__name__) and not name.startswith("_")
            if own and (inspect.isfunction(thing) or inspect.isclass(thing)):
                yield f"{room.__name__}.{name}", thing


@pytest.mark.parametrize("thing", [thing for _, thing in public()], ids=[name for name, _ in public()])
def test_it_has_a_docstring_and_types(thing):
    assert thing.__doc__ and len(thing.__doc__) > 20
    if inspect.isclass(thing):
        methods = [name for name, each in vars(thing).items() if inspect.isfunction(each) and not name.startswith("_")]
        assert all(inspect.getdoc(getattr(thing, name)) for name in methods)
    else:
        hints = thing.__annotations__
        assert set(inspect.signature(thing).parameters) <= set(hints) and "return" in hints
