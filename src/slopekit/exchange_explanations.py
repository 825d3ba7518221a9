"""The long texts of the codes of `slopekit export`."""

from collections.abc import Mapping

EXCHANGE: Mapping[str, str] = {
    "E360": "The suffix of the file says its format. STL and OBJ hold surfaces; GLB and glTF are for viewers and the "
    "web; VTU is for ParaView, with fields; DXF is for CAD and mining programs.",
    "E361": "`slopekit export` reads the JSON that `slopekit run -o DIR` or `--json` writes, not the design itself.",
    "E362": "The scene (blocks, interfaces, node pairs) stands in the JSON of run and wedge since slopekit 0.1.0. "
    "Results of studies (prob, sweep, check, ...) hold none, nor do older files: run the design again.",
    "E363": "Blocks are named as in the sheet and in the JSON: B1, B2, ... of a bench, C1, C2, ... of columns, or the "
    "design's own names.",
    "E364": "What can be written is blocks (closed meshes), interfaces (the polygons between them) and pairs (node "
    "pairs with their forces). STL holds surfaces of one sort, OBJ surfaces, GLB, VTU and DXF all three.",
    "E365": "What was asked for leaves nothing: see --blocks and --moving. Where no mechanism was found, or nothing "
    "had to be solved, there are no node pairs.",
    "E366": "These options do not go together. -o writes one file; --split writes a folder of meshes, one a block, "
    "as STL or OBJ; --binary is for STL.",
    "W370": "Binary STL has seven digits: at map coordinates that is decimetres. Leave --binary out: text holds every "
    "digit.",
    "W376": "Designs of kind blocks know uniform strengths and mean pressures on the interface of two blocks, forces, "
    "passive bolts and a seismic load. The rest of the design the result came from cannot be written in them. Blocks "
    "in space are cut into node pairs from other corners than in the first run: factors differ, usually by less than "
    "1 %, by far more where the limit state is not the only one. Run blocks.yaml and compare before you build on it.",
    "W377": "A curved slip surface is analysed with its true normals and volume. Files hold its flat triangles, "
    "inside the curve where it is convex: their volume is 0.1 to 1 % less.",
}  # fmt: skip
