"""What an accuracy decides wrongly."""

import numpy as np
import pytest

from footopt.studies.accuracy import wrong_pairs


def test_a_right_order_turns_no_pair_round_and_its_reverse_all_of_them():
    truth = np.array([-3.0, -1.0, -2.0, 4.0])
    assert wrong_pairs(10.0 + 1e-3 * truth, truth) == 0.0
    assert wrong_pairs(-truth, truth) == 1.0
    assert wrong_pairs(np.array([-3.0, -2.0, -1.0, 4.0]), truth) == pytest.approx(1 / 6)


def test_a_tie_or_a_failed_walk_where_there_is_an_order_is_a_wrong_pair():
    assert wrong_pairs(np.array([1.0, 1.0]), np.array([1.0, 2.0])) == 1.0
    assert wrong_pairs(np.array([1.0, np.nan]), np.array([1.0, 2.0])) == 1.0
    assert np.isnan(wrong_pairs(np.array([1.0]), np.array([1.0])))
