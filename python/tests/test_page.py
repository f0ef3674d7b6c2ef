"""docs/python.md runs, and prints what it says; the Python of README.md runs."""

import contextlib
import io
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "python.md"


def test_the_page_prints_what_it_says():
    blocks = re.findall(r"```python\n(.*?)```\n(?:```text\n(.*?)```\n)?", PAGE.read_text(encoding="utf-8"), re.S)
    assert len(blocks) >= 8
    names: dict = {}
    for code, expected in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, str(PAGE), "exec"), names)
        assert printed.getvalue() == expected, code


def test_the_figures_of_the_page_are_there():
    for image in re.findall(r"!\[.*?\]\((.*?)\)", PAGE.read_text(encoding="utf-8")):
        size = (PAGE.parent / image).stat().st_size
        assert 10_000 < size < 150_000, f"{image}: {size} bytes"


def test_the_python_of_the_readme_moves_particles():
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    names: dict = {}
    exec(compile(code, "README.md", "exec"), names)
    position = names["particles"]["pos"]
    assert (position >= 0).all() and (position < 1000).all() and names["particles"]["vel"].any(axis=1).all()
