"""Files that a run leaves are there as a whole, or as they were."""

import pytest

from footopt.errors import FileError
from footopt.files import io as files


def breaks_off(path, error):
    with files.write_whole(path) as new:
        new.write_text("a\n1")
        raise error


@pytest.mark.parametrize(
    ("error", "seen"), [(OSError(28, "No space left"), FileError), (KeyboardInterrupt(), KeyboardInterrupt)]
)
def test_a_file_that_breaks_off_leaves_the_old_one(tmp_path, error, seen):
    path = tmp_path / "designs.csv"
    path.write_text("as it was")
    with pytest.raises(seen) as caught:
        breaks_off(path, error)
    assert seen is KeyboardInterrupt or "designs.csv (No space left)" in str(caught.value)
    assert path.read_text() == "as it was"
    assert [p.name for p in tmp_path.iterdir()] == ["designs.csv"]
