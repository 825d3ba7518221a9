"""How large it is what moves in each mechanism of many blocks."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from slopekit.block_scene import BlockSizes
from slopekit.core.arrays import Bools, Ints
from slopekit.findings import Mechanism
from slopekit.kinds.many_blocks_scene import AssemblyScene
from slopekit.kinds.sizes import Crest, extents_of, on_plane


def with_sizes(mechanisms: Iterable[Mechanism], scene: AssemblyScene, gravity_m_s2: float) -> Iterator[Mechanism]:
    """The mechanisms with the sizes of the blocks that move in each."""
    index = {name: k for k, name in enumerate(scene.names)}
    for one in mechanisms:
        blocks = np.array([index[block.name] for block in one.blocks], dtype=np.int64)
        yield replace(one, size=_sizes_of_blocks(blocks, scene, gravity_m_s2)) if len(blocks) else one


def _sizes_of_blocks(blocks: Ints, scene: AssemblyScene, gravity_m_s2: float) -> BlockSizes:
    assembly = scene.assembly
    volumes = assembly.volumes[blocks]
    volume, mass = float(volumes.sum()), float(volumes @ scene.unit_weights[blocks]) / gravity_m_s2
    if scene.outlines:
        own = [outline for name, outline in scene.outlines.items() if name != "bedrock" or name in scene.names]
        heights = np.concatenate([own[k % len(own)][:, 1] for k in blocks.tolist()])
        setback = None
        if scene.crest_x is not None:  # to the back of the last column, at its top: the third corner of an outline
            setback = max(0.0, max(float(own[k % len(own)][2, 0]) for k in blocks.tolist()) - scene.crest_x)
        return BlockSizes(volume, mass, float(np.ptp(heights)), None, setback, {})
    moves = np.zeros(len(assembly) + 1, dtype=bool)
    moves[blocks] = True
    corners = assembly.vertices[assembly.triangles[moves[assembly.triangle_block]].ravel()]
    if scene.crest is None:
        return BlockSizes(volume, mass, float(np.ptp(corners[:, 2])), None, None, {})
    extents = extents_of(corners, scene.crest)
    traces = _traces(moves, scene, scene.crest)
    return BlockSizes(volume, mass, extents.height_m, extents.face_width_m, extents.setback_m, traces)


def _traces(moves: Bools, scene: AssemblyScene, crest: Crest) -> dict[str, dict[str, float]]:
    """How long the edge of what moves (n + 1,) is on the face and on the upper slope, by joint."""
    patches = scene.assembly.patches
    traces: dict[str, dict[str, float]] = {}
    for k in np.flatnonzero(moves[patches.plus] != moves[patches.minus]).tolist():
        polygon = patches.corners[patches.first[k] : patches.first[k + 1]]
        of_joint = traces.setdefault(scene.joints[patches.joint[k]], {})
        for short, normal in (("face", crest.face), ("upper", crest.upper)):
            if length := on_plane(polygon, normal, crest.point):
                of_joint[short] = of_joint.get(short, 0.0) + length
    return {name: traces[name] for name in scene.joints if name in traces}
