"""What runs with NumPy alone and with the compiled kernels, where there are any."""

import pytest

from slopekit.preie.kernels import chosen


@pytest.fixture(params=["numpy", "compiled"])
def kernels(request, monkeypatch) -> str:
    """The way that the loops of many blocks take, one after the other."""
    monkeypatch.delenv("SLOPEKIT_KERNELS", raising=False)
    found, missing = chosen()
    if request.param == "compiled" and found is None:
        pytest.skip(missing)
    monkeypatch.setenv("SLOPEKIT_KERNELS", request.param)
    return request.param
