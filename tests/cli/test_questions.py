"""What is asked of a search, and how plainly it answers."""

import json

from running import footopt, only_folder

TINY = ["accuracy=draft", "study.confirm=null", "solver.pop_size=4", "solver.n_gen=1"]


class TestTheAnswer:
    def test_a_best_design_that_is_worse_than_the_flat_sole_is_said_to_be(self, tmp_path):
        """No gain is made of a loss, and no share of one."""
        done = footopt(*TINY, "sand=hard", "solver=ga", cwd=tmp_path)
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert result["objectives"]["efficiency"] > result["flat"]["efficiency"]
        assert "The best design is worse than the flat sole in efficiency J_W: -1.308e-4" in done.stdout
        assert "6.9 % worse" in done.stdout
        assert "share" not in done.stdout.partition("Validity")[0]
        assert set(result["gain_shares"].values()) == {None}

    def test_says_of_what_it_was_made_and_where(self, tmp_path):
        footopt(*TINY, cwd=tmp_path)
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert {"llvmlite", "moocore", "numba"} <= set(result["versions"])
        assert set(result["machine"]) == {"processor", "vector_bits", "system"}
        assert result["commit"] is None or len(result["commit"].removesuffix("-dirty")) == 40
        assert "report.html" in result["wall_time_covers"]
