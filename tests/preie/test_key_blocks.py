"""Single blocks that slide out of a bench by themselves, against the Hoek & Bray wedge in vector form."""

import numpy as np
import pytest

from slopekit.closed_form.wedge import hoek_bray_wedge
from slopekit.orientation import Plane
from slopekit.preie.key_blocks import sliding_factor
from tests.support import random_wedge, upward_normal


@pytest.mark.parametrize("seed", range(40))
def test_a_block_on_two_faces_is_a_wedge(seed) -> None:
    """Forces alone, cohesion on the faces in contact: the same number by another formula; None is no number."""
    wedge = random_wedge(np.random.default_rng(seed)) | {"water": None, "bolts": None, "seismic": None}
    joints = tuple(Plane(*plane) for plane in wedge["dips"])
    exact = hoek_bray_wedge(
        joints, Plane(*wedge["face"]), Plane(*wedge["upper"]), wedge["height"], tuple(wedge["c"]),
        tuple(wedge["phi"]), wedge["unit_weight"],
    )  # fmt: skip
    normals = np.array([upward_normal(plane) for plane in wedge["dips"]])
    cohesion = np.array(wedge["c"]) * exact.areas[:2]
    found = sliding_factor(
        normals, np.array([0.0, 0.0, -exact.weight]), cohesion, np.tan(np.radians(np.array(wedge["phi"])))
    )
    if exact.status == "slides_on_both" or exact.status.startswith("slides_on_J"):
        assert found == pytest.approx(exact.factor, rel=1e-9)
