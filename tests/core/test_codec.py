"""Digests of documents: SHA-256 as hashlib has it, which a plain run does not load."""

import hashlib

import pytest

from slopekit.core.codec import digest


@pytest.mark.parametrize(
    ("document", "text"),
    [({"b": [1, 2.5], "a": None}, '{"a": null, "b": [1, 2.5]}'), ("φ", '"\\u03c6"'), ({}, "{}")],
)
def test_a_digest_is_the_sha_256_of_the_document_with_its_keys_in_order(document, text) -> None:
    assert digest(document) == hashlib.sha256(text.encode()).hexdigest()
