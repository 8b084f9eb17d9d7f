"""What accuracies promise holds outside the examples, over random scenes and feet."""

import os

import pytest
from random_scenes import draw, judge, promises

#: Scenes by number: the first FOOTOPT_SCENES (docs/evidence/accuracy.md), or ten whose code other tests
#: compile, too.
SCENES = range(int(os.environ.get("FOOTOPT_SCENES", 0))) or (0, 2, 6, 9, 10, 11, 14, 5001, 5046, 5058)


@pytest.mark.slow
def test_random_scenes_keep_the_promise_and_estimates_hold_the_error():
    """Of these walks 97 % are within 0.5 %, and 78 % were by presets that do not follow the scene."""
    found = []
    for number in SCENES:
        drawn = draw(number)
        found += judge(drawn.feet[:2], drawn.scene, space=drawn.space)
    told = promises(found)
    assert told["another outcome"] == 0
    assert told["within the tolerance"] >= 0.82, told
    assert told["covered"] >= 0.95, told
    assert told["at most 5 times"] >= 0.85, told
