"""Tolerances of `preie`: what a computed quantity is compared with, in one place.

Models are scaled: forces in parts of the load, lengths in parts of the block or assembly. A tolerance of one algorithm
that is no comparison (steps, numbers of steps, sizes from which another way is quicker) stands with the algorithm.
"""

import sys

# -- Nothing: rounding, and what divides by it ------------------------------------------------------------------------

#: Kept from a division by nothing: no length, force or strength of a scaled model comes near it.
TINY = 1e-300

#: What solving a small system of equations leaves, in parts of its numbers, some 450 spacings of doubles: Newton's
#: method has ended there. Ten times more moves factors in their twelfth digit, ten times less nothing.
ROUNDING = 1e-13

#: Unbalanced force, in parts of the springs' forces: what adding them up leaves, ten spacings of doubles.
SPRING_ROUNDING = 10.0 * sys.float_info.epsilon

#: Added to the diagonal of a stiffness, in parts of it: blocks that nothing holds have a stiffness too. Ten times as
#: much moves a factor in two sections of 37.
DIAGONAL_SHIFT = ROUNDING

#: The same, in parts of the elastic stiffness, for the modes of a limit state: there may be several motions. A tenth of
#: it takes another in 4 sections of 450 (358 has 1.302 for 1.507).
MODES_SHIFT = 10.0 * ROUNDING

#: Force, in parts of the load, or tan φ, that is none: some ten times what is left where forces balance.
NO_FORCE = 10.0 * ROUNDING

#: Normal traction, in parts of the mean: lower ones get the strength line of this one.
LEAST_TRACTION = 1e-6

#: What is none of lengths and directions: the cross product of two unit normals, work of a force or opening of a
#: contact along a line or plane, how far a patch is from a parallelogram, entries of A Aᵀ - I of the axes of a contact.
#: Thousands of roundings, and far below what a slope is measured to.
PARALLEL = 1e-9

#: Size of the multipliers of a factorisation: beyond it pivots of one front only leave too few digits.
PIVOT_GROWTH = 1e8

# -- Motions: what moves, opens, slips or pulls -----------------------------------------------------------------------

#: Opening or slip of an exact mechanism, or what it draws a bolt out by, in parts of its fastest motion, that is none:
#: a mechanism is known to some 1e-8 of that.
NO_MOTION = 1e-6

#: The same where the motion of an elastic path has settled and no limit state is exact. Ten times as much or a tenth
#: moves none of 28 designs.
OPENS_ROUGHLY = 1e-4

#: Opening, in parts of the largest slip or opening, that parts a pair of one block. Ten times as much moves the factors
#: of two curved surfaces by 1e-4 and 7e-4.
OPENS = 1e-5

#: Speed of a block, in parts of the fastest of its mechanism: slower ones are at rest. Opening or slip, in parts of the
#: largest, and missing strength, in parts of it, that are none where a motion is cleaned onto its exact kinematics.
MOVES = 1e-3

#: The same while blocks still flow: the slow ones have not come to their motion yet.
FLOWS = 0.05

#: Normal force, in parts of the largest, or of all, that a pressed pair has.
CARRIES = 1e-6

#: Strength along a motion, in parts of it, that blocks may not need just before its limit.
MOBILISED = 5e-2

#: Twist of a contact in parts of its slip and of all work: a larger one needs finer node pairs.
TWISTS = 1e-2

#: Work, in parts of the elastic: blocks that have done more since their last rest run (docs/method.md).
RUNS = 30.0

#: Elastic displacements within which blocks that ran may come to rest once more, and to which those that creep are
#: followed. Of one block one is that in which it rests as a first point slips, of many the elastic work.
FAR = 1e4

#: Angle (°, root mean square) by which a motion leaves a surface: one of less is let through.
TANGENT_DEG = 1.0

#: Motions that leave the surface by more than this times what the load's does are not the surface's own.
ALIKE_MOTIONS = 3.0

#: Angle (°, root mean square) that normals are turned by at most: beyond it the surface must dilate.
FARTHEST_DEG = 10.0

#: Sine of that angle below which nothing needs to be turned.
TURNED = 1e-7

#: Work of the load on a motion, in parts of the most it does on any: a motion of less is not driven.
DRIVEN = 1e-6

#: Slope of ln λ along the path of the cracked base, or motion per change of it, that is none: λ is within its square of
#: the least.
LEVEL = 1e-7

# -- Balance: unbalanced force that is none ---------------------------------------------------------------------------

#: Of Newton's method on elastic joints, in parts of the largest force: two steps before rounding stops it. Of one block
#: on its elastic bed, in parts of the load.
SETTLED = 1e-10

#: Gap in parts of what the mean load presses into the mean contact: less is none, it comes from rounding.
TOUCHES = 1e-9

#: The same where it takes no further step: still good for seven digits of λ.
ROUGHLY_SETTLED = 1e-8

#: Of each block on elastic joints, and in a program, in parts of its own load, and of what a program
#: says of strengths; load that a proposal may shed. Ten times as much moves none of 23 designs, a tenth, in programs,
#: one.
EACH_BALANCED = 1e-6

#: Load, in parts of the heaviest block's: the balance of a lighter block is weighed by this one, as what is less is
#: rounding of the others. Benches hold slivers a millionth of their largest block. A hundredth, or ten times as much,
#: moves none of 25 designs.
LIGHTEST = 1e-7

#: Of a limit of many blocks, in parts of the load of the block it acts on: more is no limit state.
LIMIT_BALANCED = 1e-5

#: How far its forces may be outside their bounds, in parts of the load.
ADMISSIBLE = 1e-7

#: Of an exact limit state, of one block at one factor, in a step of shaking, and of forces that prove a bound, in parts
#: of the load, or of the largest force; what its forces may be beyond strength; strength, or work, that is none beside
#: it. At one factor Newton's method aims at a thousandth of it.
EQUILIBRIUM = 1e-9

# -- Searches: where one ends -----------------------------------------------------------------------------------------

#: Tolerance of a cone program, and complementarity of a proposal; distance of admissible forces from those of a
#: mechanism, in parts of the load, beyond which a range ends: it moves ends of ranges in their seventh digit.
SOLVED = 1e-9

#: The same while λ changes by more than `ROUGHLY_CLOSE`: half the steps.
ROUGHLY_SOLVED = 1e-4

#: Change of λ, or width of its bracket, in parts of it, below which programs are solved to `SOLVED`.
ROUGHLY_CLOSE = 2e-2

#: Newton step of λ, in parts of it, that ends a search: the next would be its square.
NEAR = 1e-5

#: Complementarity of a static bound and width of its bracket, in parts of the load factor: six digits.
CLOSE = 3e-7

#: Viscous force, in parts of the load, below which the limit state of the modes is tried; in space their directions of
#: slip have to have settled too. From 0.015 to 0.7 in sections, from 1e-4 to 0.01 in space, 23 designs move by 1e-13.
VISCOUS_LEFT = 1e-2

#: Rounding of the joints of thousands of blocks at rest, in parts of their elastic energy: 0.05 % beyond the limits of
#: three benches it is twice that, five times of more blocks, and grows.
LAGGED_ROUNDING = 5e-3

#: Between the last rest and a motion, in parts of the factor: a limit known so well has settled.
LIMIT_SETTLED = 1e-4

#: Change of displacements, in parts of the largest, that ends the rounds of stiffnesses.
SETTLEMENT_STEADY = 1e-3

#: Step of ln F towards a factor: one that no shorter step reaches has no equilibrium.
SHORTEST_STRIDE = 1e-5

#: Part of λ, or of the displacement: no rest at so little less strength, no shorter step, no nearer landing is tried.
PATH_ENDS = 1e-6

#: Change of F, in parts of it, by splitting the triangles of a pressed part once more: beyond it, it is done.
FINER_PRESSED = 3e-4

#: Change of a limit, in parts of it, by finer node pairs: one that moves by less is settled.
MESH_CHANGE = 2e-3

# -- Sameness: how near two factors are one, in parts of them ---------------------------------------------------------

#: Limits so near are one. A path in space has ended where λ changes by no more in a step, and viscous force is no more
#: of the load: so well its factor is known. Components that fail so near to each other fail together, and moments
#: govern a limit that is lower than that of the forces alone by more; a static bound lower than the limit by more is
#: none: one of the two searches has lost its way.
SAME_LIMIT = 1e-6

#: Factors that agree to what is printed; node pairs move them by more.
SAME_FACTOR = 1e-4

#: An exact state farther than this from where the path settled, or from a least λ, is another one.
POLISHED = 1e-5

#: To this static bounds of many blocks are known, and balance in parts of the load of each block: a factor above one by
#: more is none.
BOUND_ACCURACY = 1e-4

#: The same of so many blocks that no cone programs decide: motions close slivers by as much (of 3,199 by 1.07e-4).
BOUND_ROUGHLY = 1e-3

#: Where all blocks rest this near to the factor of a group, the last state at rest is an answer.
RESTS_NEAR = 5e-2

# -- Limits of what is a number ---------------------------------------------------------------------------------------

#: Factor, load multiplier, or work in parts of the elastic: beyond it, or below its inverse, there is none. A Newton
#: step to a limit state, whose unknowns are of order one, that is longer has lost the way.
FARTHEST = 1e6

#: Strength, in parts of the full, or λ: what stands at it stands without any, and forces that balance at it do without
#: friction. Ten times as much or a tenth moves none of 25 designs.
LEAST_STRENGTH = 1.0 / FARTHEST

#: A bound so many times the limit is none: joints that dilate lock the block.
BOUND_BEYOND = 1e3

#: A range of factors that goes on beyond so many times the factor is cut there.
WIDEST_RANGE = 50.0
