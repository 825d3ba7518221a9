"""The command on one design that is not made of a function of scripts: lint."""

from pathlib import Path
from typing import Annotated

import typer

from slopekit._version import __version__
from slopekit.cli.common import CASE, FILE, JSON, SET, json_text, load_design
from slopekit.core.codec import json_of


def lint(
    design: Annotated[str, FILE],
    sets: Annotated[list[str] | None, SET] = None,
    case: Annotated[str | None, CASE] = None,
    as_json: Annotated[bool, JSON] = False,
) -> None:
    """Read and test a design file, run nothing."""
    from slopekit.kinds import likely_slips

    read = load_design(design, sets, case)
    slips = likely_slips(read)
    if as_json:
        document = {
            "slopekit": __version__, "kind": read.kind, "input_sha256": read.input_hash(), "inputs": read.inputs(),
            "assumed": dict(read.assumed), "defaults": list(read.reading.defaults), "warnings": json_of(slips),
            "errors": [],
            **({"cases": {one.name: {
                "sets": dict(one.sets), "rules": [str(rule) for rule in one.design.rules],
                "input_sha256": one.design.input_hash(), "inputs": one.design.inputs(),
            } for one in read.cases}} if read.cases else {}),
        }  # fmt: skip
        typer.echo(json_text(document))
        return
    head = f"ok   {Path(design).name}: a {read.kind} design, sha {read.input_hash()[:6]}"
    typer.echo(f"{head} (whether it forms a block, run says)")
    if read.analysis.partial is not None:
        typer.echo(f"     partial factors: {read.analysis.partial.called}")
    for one in read.cases:
        rules = ", ".join(str(rule) for rule in one.design.rules) or "nothing"
        typer.echo(f"     case {one.name}: sets {one.in_words or 'nothing'}; asks for {rules}")
    for name, value in read.assumed:
        typer.echo(f"     {name} is a distribution: run takes {value}")
    if read.reading.defaults:
        typer.echo(f"     left out, taken by default: {', '.join(read.reading.defaults)}")
    for notice in slips:
        typer.echo(f"     {notice}")
