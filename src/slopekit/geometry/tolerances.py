"""Tolerances of `geometry`: what a computed quantity is compared with, in one place.

Bodies are moved to the origin and scaled before they are cut: "of the body" is in parts of half its size. Counts and
sizes that bound memory stand with their algorithms.
"""

import math

import numpy as np

# -- Nothing: rounding, and what divides by it ------------------------------------------------------------------------

#: Kept from a division by nothing: no length or area of a model comes near it.
TINY = 1e-300

#: Sine of the angle, or rate of approach per length, below which lines and planes of a bench do not meet.
PARALLEL = 1e-9

#: Sine of the angle below which two planes of a wedge are one (0.00006°): as in `closed_form.tolerances`, so that both
#: refuse the same wedges.
SAME_DIRECTION = 1e-6

#: Angle (°) below which two planes of a section are one: as in `closed_form.tolerances`.
PARALLEL_DEG = 1e-4

#: Angle (°) between face and upper slope of a bench: closer ones make no crest.
SAME_DIP_DEG = 0.01

#: Dip (°) of the face of a bench: a flatter one is no bench.
FLATTEST_FACE_DEG = 1.0

#: Sine of the angle between two joints (5°) that is worth a word: their line moves by degrees with a degree of dip.
NEARLY_PARALLEL = math.sin(math.radians(5.0))

#: Rounding of an area, in parts of the square of a length: all that a sliver's area has left.
LENGTH_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)

#: Control areas may miss the interface's area by this part of it.
AREA_SUM = 1e-9

#: Volume of a cell, of a body 2 long, whose centroid would be lost to rounding.
NO_VOLUME = 1e-15

#: Area of a face, in parts of the square of half the body's size, that is none.
NO_AREA = 1e-12

#: Squared sine of the angle between two faces of a corner of a slip surface that do not turn.
NO_TURN = 1e-9

#: Sine of the angle that two sides of a face turn by at a corner: at less there is none.
BENT = 1e-6

#: Rise of the unit normal of a sheet's facet: one of less stands upright.
UPRIGHT = 1e-6

# -- Nearness: what touches, coincides or lies inside -----------------------------------------------------------------

#: Depth, of the body: lines and points that touch it no deeper are outside.
INSIDE = 1e-9

#: Distance, of the body: corners as near as this to a straight edge are none.
STRAIGHT = 1e-11

#: Distance, of the body, of a cell's corners from the plane that made them: beyond it the cut is refused.
OFF_PLANE = 1e-9

#: Distance, of a block's size: corners of its cells nearer than this are one.
SAME_CORNER = 1e-6

#: Distance, of a body's size, between planes of joint sets, or to a face of the body: nearer ones are one.
SAME_PLANE = 1e-6

#: Distance, in parts of an outline, of a corner that lies on an edge.
ON_EDGE = 1e-12

#: Distance, of the contact tolerance: corners of an outline nearer than this to each other or to the line past them are
#: dropped, and an outline so near to itself meets itself.
OUTLINE_CLEAN = 1e-3

#: Distance, of the contact tolerance: triangles of a face lie this near to its plane.
FACE_FLAT = 0.1

#: Cosine between edges or faces that can lie on each other; how far apart they are decides.
OPPOSITE = -0.99

#: Gap, in parts of the mean block size: what is nearer than this and does not touch is reported.
NEARLY_TOUCHES = 0.01

#: Contact tolerance for rounded corners at most, in parts of the mean block size: more is no rounding.
LARGEST_ROUNDING = 0.01

#: The same in parts of the thickness (area / half of the boundary) of the thinnest block.
LARGEST_ROUNDING_OF_THINNEST = 0.1

#: Contacts are looked for with so many times the contact tolerance, and with it divided by that.
DOUBT = 3.0

#: Sine of the angle between edges that touch, beyond which rounded corners have turned them: corners with seven digits
#: and more turn them less.
TURNED_BY_ROUNDING = 1e-6

#: Resolution of single precision at the size of a mesh's coordinates, in parts of the mesh: a coarser one is refused.
COARSEST_SINGLE = 1e-3

#: Distance that planes of a stack keep over a body 2 long.
LEAST_GAP = 1e-7

#: Cosine between a plane's normal and its stack's axis below which it needs a stack of its own.
LEAST_RISE = 0.3

# -- Conservation: what a cut may lose --------------------------------------------------------------------------------

#: What volumes and areas of a bench may be off, in parts of them, before the cut is refused.
CUT_BALANCE = 1e-6

#: What the volume of a sliding mass and of the rest of the ground may miss of the whole, in parts of it.
MASS_BALANCE = 1e-9

#: Volume, of a body's or a sliding mass's: a piece that rounding made or may unmake.
NUMERICAL_SLIVER = 1e-9

#: Area, of the largest control area: slivers along the rim that moving it onto the surface turned over.
SLIVER_AREA = 1e-9
