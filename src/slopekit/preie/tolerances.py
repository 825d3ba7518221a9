"""Tolerances of `preie` in one place: the numbers with which computed quantities are compared.

Models are scaled: forces in parts of the load, lengths in parts of the block or assembly. Parameters of one algorithm
that are no comparison (steps, numbers of steps, sizes at which another method is faster) are defined with it.
"""

import sys

# -- Rounding: differences that count as zero -------------------------------------------------------------------------

#: Least denominator, which prevents division by zero: no length, force or strength of a scaled model is as small.
TINY = 1e-300

#: Residual of a small system of equations, relative to its entries, at which Newton's method ends: some 450 spacings
#: of doubles. Ten times more changes factors in their twelfth digit, ten times less changes none.
ROUNDING = 1e-13

#: Unbalanced force, in parts of the springs' forces, due to rounding of their sum: ten spacings of doubles.
SPRING_ROUNDING = 10.0 * sys.float_info.epsilon

#: Shift of the diagonal of a stiffness, in parts of it, which makes it regular for free blocks too. Ten times as much
#: changes a factor in two sections of 37.
DIAGONAL_SHIFT = ROUNDING

#: Shift of the diagonal, in parts of the elastic stiffness, for the modes of a limit state, which may have several
#: motions. A tenth of it selects another motion in 4 sections of 450 (358 has 1.302 for 1.507).
MODES_SHIFT = 10.0 * ROUNDING

#: Force, in parts of the load, or tan φ, that counts as zero: some ten times the residual of balanced forces.
NO_FORCE = 10.0 * ROUNDING

#: Normal traction, in parts of the mean, below which a curved law has the strength line of this traction.
LEAST_TRACTION = 1e-6

#: Relative length or direction that counts as zero: the cross product of two unit normals, work of a force or opening
#: of a contact along a line or plane, deviation of a patch from a parallelogram, entries of A Aᵀ - I of the axes of a
#: contact. Thousands of roundings, and far below the accuracy of measured slopes.
PARALLEL = 1e-9

#: Size of the multipliers of a factorisation, beyond which pivoting within one front loses too many digits.
PIVOT_GROWTH = 1e8

# -- Motions: what moves, opens, slips or pulls -----------------------------------------------------------------------

#: Opening, slip or bolt extension of an exact mechanism, in parts of its fastest motion, that counts as zero: a
#: mechanism is accurate to some 1e-8 of that.
NO_MOTION = 1e-6

#: Opening or slip that counts as zero in the settled motion of an elastic path, without an exact limit state. Ten
#: times as much or a tenth changes none of 28 designs.
OPENS_ROUGHLY = 1e-4

#: Opening, in parts of the largest slip or opening, at which a node pair of one block debonds. Ten times as much
#: changes the factors of two curved surfaces by 1e-4 and 7e-4.
OPENS = 1e-5

#: Speed, in parts of the fastest block of a mechanism, below which a block is at rest. Opening or slip, in parts of
#: the largest, and unused strength, in parts of it, that count as zero where a motion is made kinematically exact.
MOVES = 1e-3

#: Speed, in parts of the fastest block, below which a block is at rest while the blocks flow viscously.
FLOWS = 0.05

#: Normal force, in parts of the largest or of the total, above which a node pair is pressed.
CARRIES = 1e-6

#: Unused strength along a motion, in parts of it, that is allowed just before its limit.
MOBILISED = 5e-2

#: Twist of a contact, in parts of its slip and of all work, above which it needs finer node pairs.
TWISTS = 1e-2

#: Work since the last state of rest, in parts of the elastic work, above which blocks run (docs/method.md).
RUNS = 30.0

#: Elastic displacements within which running blocks may come to rest again, and to which creeping blocks are followed.
#: The unit is the displacement of one block at its first slip, and the elastic work of many.
FAR = 1e4

#: Angle (°, root mean square) between a motion and a surface, below which the surface allows the motion.
TANGENT_DEG = 1.0

#: Ratio of the angles of a motion and of the one that the load drives, above which a surface does not allow it.
ALIKE_MOTIONS = 3.0

#: Largest angle (°, root mean square) by which normals are turned: beyond it the surface must dilate.
FARTHEST_DEG = 10.0

#: Sine of the angle of normals below which they are not turned.
TURNED = 1e-7

#: Work of the load on a motion, in parts of the largest on any, below which the load does not drive it.
DRIVEN = 1e-6

#: Slope of ln λ along the path of a cracked base, or motion per change of ln λ, that counts as zero: λ is within its
#: square of the least.
LEVEL = 1e-7

# -- Balance: unbalanced force that counts as zero --------------------------------------------------------------------

#: Unbalanced force of Newton's method on elastic joints, in parts of the largest force: two steps above rounding. Of
#: one block on its elastic bed, in parts of the load.
SETTLED = 1e-10

#: Gap, in parts of the compression of the mean contact by the mean load, that counts as zero: it is rounding.
TOUCHES = 1e-9

#: Unbalanced force accepted where Newton's method on elastic joints takes no further step: seven digits of λ.
ROUGHLY_SETTLED = 1e-8

#: Unbalanced force of each block on elastic joints and in a program, in parts of its load; violation of strength in a
#: program; load that a candidate may shed. Ten times as much changes none of 23 designs, a tenth, in programs, one.
EACH_BALANCED = 1e-6

#: Least load, in parts of that of the heaviest block, by which the balance of a block is scaled; less is rounding of
#: the others. Benches have slivers a millionth of their largest block. A hundredth, or ten times as much, changes none
#: of 25 designs.
LIGHTEST = 1e-7

#: Unbalanced force of a limit state of many blocks, in parts of the load of the block it acts on.
LIMIT_BALANCED = 1e-5

#: Violation of the bounds of contact forces of a limit state, in parts of the load.
ADMISSIBLE = 1e-7

#: Unbalanced force of an exact limit state, of one block at one factor, in a step of shaking, and of forces that prove
#: a bound, in parts of the load or of the largest force; force in excess of strength; strength, or work, that counts
#: as zero relative to it. At one factor Newton's method aims at a thousandth of it.
EQUILIBRIUM = 1e-9

# -- Searches: criteria at which they end -----------------------------------------------------------------------------

#: Tolerance of a cone program, and complementarity of a candidate; distance of admissible forces from those of a
#: mechanism, in parts of the load, at which a range ends: it changes ends of ranges in their seventh digit.
SOLVED = 1e-9

#: Tolerance of a cone program while λ changes by more than `ROUGHLY_CLOSE`: half the steps.
ROUGHLY_SOLVED = 1e-4

#: Change of λ, or width of its bracket, in parts of it, below which programs are solved to `SOLVED`.
ROUGHLY_CLOSE = 2e-2

#: Newton step of λ, in parts of it, that ends a search: the next would be of the order of its square.
NEAR = 1e-5

#: Complementarity of a static bound and width of its bracket, in parts of the load factor: six digits.
CLOSE = 3e-7

#: Viscous force, in parts of the load, below which the limit state of the contact modes is tried; in space once their
#: slip directions are constant. From 0.015 to 0.7 in sections, and 1e-4 to 0.01 in space, 23 designs change by 1e-13.
VISCOUS_LEFT = 1e-2

#: Rounding of the joints of thousands of blocks at rest, in parts of their elastic energy: 0.05 % beyond the limits of
#: three benches it is twice that, five times of more blocks, and grows.
LAGGED_ROUNDING = 5e-3

#: Width of the bracket between rest and motion, in parts of the factor, at which a limit has settled.
LIMIT_SETTLED = 1e-4

#: Change of displacements, in parts of the largest, that ends the rounds of stiffnesses.
SETTLEMENT_STEADY = 1e-3

#: Least step of ln F towards a factor: without convergence at it there is no equilibrium.
SHORTEST_STRIDE = 1e-5

#: Least relative change of λ, or of the displacement, along a path: no shorter step is tried.
PATH_ENDS = 1e-6

#: Change of F, in parts of it, by splitting the triangles of a pressed part once more, above which they are split.
FINER_PRESSED = 3e-4

#: Change of a limit, in parts of it, by finer node pairs, below which it has settled.
MESH_CHANGE = 2e-3

# -- Equality of two factors, in parts of them ------------------------------------------------------------------------

#: Difference of limits that count as equal. A path in space ends where a step changes λ, and viscous force is a part
#: of the load, by no more. Components whose limits differ by less fail together; moments govern a limit lower than
#: that of the forces alone by more; a static bound lower than the limit by more is wrong: one of the two searches
#: failed.
SAME_LIMIT = 1e-6

#: Difference of factors that agree in the printed digits; other node pairs change them by more.
SAME_FACTOR = 1e-4

#: Largest distance of an exact limit state from the end of its path, or from a least λ.
POLISHED = 1e-5

#: Accuracy of static bounds of many blocks, and of their balance in parts of the load of each block: a factor that
#: exceeds its bound by more is rejected.
BOUND_ACCURACY = 1e-4

#: Accuracy of static bounds of too many blocks for cone programs: motions close slivers by as much (1.07e-4 of 3,199).
BOUND_ROUGHLY = 1e-3

#: Gap below the factor of a group within which the last state of rest of all blocks is accepted as its limit.
RESTS_NEAR = 5e-2

# -- Range of meaningful numbers --------------------------------------------------------------------------------------

#: Largest factor, load multiplier, or work in parts of the elastic; its inverse is the least. A longer Newton step to
#: a limit state, whose unknowns are of order one, diverges.
FARTHEST = 1e6

#: Strength, in parts of the full, or λ, that counts as zero: blocks stable at it need no strength. Ten times as much
#: or a tenth changes none of 25 designs.
LEAST_STRENGTH = 1.0 / FARTHEST

#: Ratio of static bound and limit above which there is no bound: joints that dilate lock the block.
BOUND_BEYOND = 1e3

#: Ratio to the factor at which a range of factors is cut off.
WIDEST_RANGE = 50.0
