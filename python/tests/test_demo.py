"""The demonstration runs, and finds what the paper found."""

import pytest

pytest.importorskip("matplotlib")

from fixpair.demo.__main__ import main  # noqa: E402


def test_the_demonstration_tells_its_story(tmp_path, capsys):
    main(["--size", "32", "--box", "1000", "--seeds", "3", "--output", str(tmp_path)])
    rows = {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if "+/-" in line}
    scatter = {name: float(rows[name].split()[1]) for name in ("Normal", "Fixed", "Fixed-Paired")}
    assert scatter["Fixed-Paired"] < scatter["Fixed"] < 0.5 * scatter["Normal"]
    for name in ("power.png", "f_nl.png"):
        assert (tmp_path / name).stat().st_size > 10_000


@pytest.mark.parametrize("words", [["--size", "16"], ["--seeds", "2"], ["--sizes", "64"]])
def test_what_makes_no_story_is_refused(words, capsys):
    with pytest.raises(SystemExit):
        main(words)
    assert "usage" in capsys.readouterr().err
