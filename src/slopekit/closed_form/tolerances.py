"""Tolerances of `closed_form`: what a computed quantity is compared with, in one place."""

# -- Nothing: rounding ------------------------------------------------------------------------------------------------

#: Force, moment or volume, in parts of the load (of the sliding body), that counts as nothing; cosine of a face that is
#: vertical: thousands of roundings.
SMALL = 1e-12

#: Moment or force of a toppling column, in parts of what is added up, that is nothing.
ROUNDING = 1e-14

#: A bolt that the movement draws out by less (times the load) is square to it and does not act.
SQUARE = 1e-12

#: Sine of the angle below which two planes of a wedge are one (0.00006°): as in `geometry.tolerances`, so that both
#: refuse the same wedges.
SAME_DIRECTION = 1e-6

#: Angle (°) below which two planes of a section are one: as in `geometry.tolerances`.
PARALLEL_DEG = 1e-4

#: Outward run of a wedge's line, in parts of its length, that is none: rounding.
DAYLIGHTS = 1e-12

#: Cosine of the angle to the face below which the last bit says on which side of it a line runs.
ALONG = 1e-9

#: Length of a joint, in parts of what a block needs, that is missing and still enough: rounding.
REACHES = 1e-9

#: Distance, of the radius, of a corner of the ground that lies on the slip circle.
ON_CIRCLE = 1e-9

# -- Balance and searches: where one ends -----------------------------------------------------------------------------

#: Normal force and spare friction at a column's base, in parts of its forces, that may be missing.
HOLDS = 1e-9

#: Change of a passive bolt's pull in a round over all of them, in parts of what it may pull.
PULLS_SETTLED = 1e-12

#: m_α, the vertical part of N and its friction by that of N alone: below it Bishop's N means nothing (Whitman & Bailey
#: 1967).
LEAST_GRIP = 0.2
