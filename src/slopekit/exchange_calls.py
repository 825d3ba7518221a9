"""Exchange as Python calls: `sk.export`; its code loads only when it is called."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from slopekit.exchange.export import Export
    from slopekit.result import Result


def export(
    result: "Result | Mapping[str, Any] | str | os.PathLike[str]",
    path: "str | os.PathLike[str] | None" = None,
    *,
    what: "str | Sequence[str]" = "blocks",
    blocks: "str | Sequence[str] | None" = None,
    moving: bool = False,
    binary: bool = False,
    split: "str | os.PathLike[str] | None" = None,
    split_as: str = "stl",
) -> "Export":
    """Write the blocks, interfaces or node pairs of a result to a file of another program.

    Parameters
    ----------
    result : a result, its JSON as a dict, or the path of the JSON file or of the folder of result.json
    path : the file, its format by the suffix: .stl .obj .glb .gltf .vtu .dxf (.dxf needs the extra `cad`)
    what : "blocks", "interfaces", "pairs", or several of them
    blocks : names of the blocks wanted, as a sequence or as "B1,B7"; moving : leave bedrock out
    binary : STL in binary, float32
    split : a folder for one closed mesh a block with a design blocks.yaml that reads them; split_as : "stl" or "obj"

    Raises
    ------
    DesignError
        E360 to E366, E129, E140: see `slopekit explain`.

    >>> import slopekit as sk, tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     done = sk.export(sk.wedge(dips=("45/115", "45/245")), pathlib.Path(folder) / "wedge.stl")
    >>> done.written[0].blocks, round(done.written[0].volume_m3)
    (1, 209461)
    """
    from slopekit.exchange.export import export as export_result

    return export_result(
        result, path, what=what, blocks=blocks, moving=moving, binary=binary, split=split, split_as=split_as
    )
