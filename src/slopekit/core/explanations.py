"""The long text of every code, for `slopekit explain CODE`: messages.toml, read only when asked for."""

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from pathlib import Path

from slopekit.core.errors import DesignError, Fault


@cache
def explanations() -> Mapping[str, str]:
    """The long texts by code, each as one line."""
    texts = tomllib.loads(Path(__file__).with_name("messages.toml").read_text(encoding="utf-8"))
    return {code: " ".join(text.split()) for code, text in texts.items()}


def explanation(code: str) -> str:
    """The long text of a code.

    Raises
    ------
    DesignError
        E142 for a code that does not exist.

    >>> explanation("e203").splitlines()[0]
    'E203'
    """
    key, texts = code.strip().upper(), explanations()
    if key not in texts:
        digits = key[:1] + key[1:].replace("O", "0").replace("I", "1").replace("L", "1")
        matches = [digits] if digits in texts else get_close_matches(key, texts, n=1)
        advice = f"Did you mean {matches[0]}?" if matches else ""
        raise DesignError([Fault("E142", f"{code} is not a code of slopekit", "", advice)])
    return f"{key}\n{texts[key]}"
