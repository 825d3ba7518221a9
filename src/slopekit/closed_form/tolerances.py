"""Tolerances of the closed forms, in one place."""

# -- Zero: rounding ---------------------------------------------------------------------------------------------------

#: Force, moment or volume, as a fraction of the load (of the sliding body), that counts as zero; cosine of a face that
#: counts as vertical: thousands of roundings.
SMALL = 1e-12

#: Moment or force of a toppling column that counts as zero, as a fraction of its summands.
ROUNDING = 1e-14

#: A bolt that the movement extends by less (times the load) is normal to it and does not act.
SQUARE = 1e-12

#: Sine of the angle below which two planes of a wedge are parallel (0.00006°): as in `geometry.tolerances`, so that
#: both refuse the same wedges.
SAME_DIRECTION = 1e-6

#: Angle (°) below which two planes of a section are parallel: as in `geometry.tolerances`.
PARALLEL_DEG = 1e-4

#: Outward run of a wedge's line of intersection, as a fraction of its length, that counts as zero: rounding.
DAYLIGHTS = 1e-12

#: Cosine of the angle to the face below which the last bit decides on which side of it a line runs.
ALONG = 1e-9

#: Missing length of a joint, as a fraction of the length that a block needs, that is still enough: rounding.
REACHES = 1e-9

#: Distance from the slip circle, as a fraction of its radius, of a corner of the ground that lies on it.
ON_CIRCLE = 1e-9

# -- Equilibrium and ends of searches ---------------------------------------------------------------------------------

#: Normal force and reserve of friction at a column's base that may be missing, as a fraction of its forces.
HOLDS = 1e-9

#: Change of a passive bolt's pull in a round over all bolts, as a fraction of its capacity, that ends the rounds.
PULLS_SETTLED = 1e-12

#: m_α, the vertical component of N and its friction over that of N alone: below it Bishop's N is meaningless (Whitman &
#: Bailey 1967).
LEAST_GRIP = 0.2
