"""A module without PALPATE_SIMULATION: a scene is refused with the name of that option."""

from __future__ import annotations

import palpate as pp
import pytest

pytestmark = pytest.mark.skipif(pp.can_simulate(), reason="this palpate was built with PALPATE_SIMULATION")


@pytest.mark.parametrize(
    "opened", [lambda: pp.Matter("dam", gpu="cpu"), lambda: pp.Session.of_scene("water", gpu="cpu")]
)
def test_a_scene_names_the_missing_option(opened):
    with pytest.raises(pp.Error, match="needs PALPATE_SIMULATION") as caught:
        opened()
    assert caught.value.status == "unsupported"
