"""Which waypoints mattered, by a run's own designs."""

import numpy as np
import pytest

from footopt.report.page.importance import importance


def test_waypoints_matter_by_the_share_of_the_variance_that_they_make():
    """Of a + 2 b (independent) b makes four fifths; of a product both make one half."""
    k = np.random.default_rng(1).integers(1, 11, (3000, 6))
    found = importance(k, k[:, 1] + 2.0 * k[:, 4])
    np.testing.assert_allclose(found["shares"], [0, 0.2, 0, 0, 0.8, 0], atol=0.01)
    assert found["explained"] == pytest.approx(1.0, abs=1e-3)
    centred = k - k.mean(axis=0)
    np.testing.assert_allclose(
        importance(k, centred[:, 0] * centred[:, 5])["shares"], [0.5, 0, 0, 0, 0, 0.5], atol=0.02
    )


def test_noise_has_no_importance_and_a_few_designs_tell_nothing():
    rng = np.random.default_rng(2)
    k = rng.integers(1, 11, (400, 6))
    assert importance(k, rng.normal(size=400)) is None
    assert importance(k[:50], k[:50, 0].astype(float)) is None
    assert importance(np.full((400, 6), 3), np.full(400, np.nan)) is None
