"""What is refused leaves nothing behind, and takes nothing away."""

import pytest
from running import footopt

REFUSED = ["study=simulate", "foot.width=-1"]


def refused(*words, cwd):
    done = footopt(*words, cwd=cwd)
    assert done.returncode != 0
    assert done.stderr.startswith("footopt: error: ")
    return done.stderr


@pytest.mark.parametrize("place", ["results", "..", ".", "results/deep"])
def test_a_refused_run_removes_no_folder_that_was_there(place, tmp_path):
    """Not even one with nothing in it but folders and links."""
    here = tmp_path / "above" / "here"
    for folder in ("results/empty", "results/deep", "linked"):
        (here / folder).mkdir(parents=True)
    (here / "results" / "link").symlink_to(here / "linked")
    before = sorted(tmp_path.rglob("*"))
    assert "foot.width" in refused(*REFUSED, f"hydra.run.dir={place}", cwd=here)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_refused_run_leaves_no_file_and_no_folder_that_was_not_asked_for(tmp_path):
    refused(*REFUSED, cwd=tmp_path)
    assert not list(tmp_path.iterdir())
    refused(*REFUSED, "hydra.run.dir=a/b/c", cwd=tmp_path)
    assert not list((tmp_path / "a" / "b" / "c").iterdir())


@pytest.mark.slow
def test_folders_of_runs_with_a_comma_between_them_are_two_jobs(tmp_path):
    done = footopt("-m", "study=simulate", "run=a,b", "hydra.sweep.dir=sweep", cwd=tmp_path)
    assert done.returncode == 1
    said = [(tmp_path / "sweep" / job / "error.txt").read_text() for job in "01"]
    assert ["run = 'a'" in said[0], "run = 'b'" in said[1]] == [True, True]
