"""The long text of every code, for `slopekit explain CODE`. Loaded only when asked for."""

from collections.abc import Mapping
from difflib import get_close_matches

from slopekit.errors import DesignError, Fault

EXPLANATIONS: Mapping[str, str] = {
    "E100": "The command line itself was not understood: an unknown option, or an option without its value. "
    "`slopekit wedge --help` lists the options; --dips takes two orientations.",
    "E101": "A dip is the angle of the plane below the horizontal: 0 is flat, 90 is vertical. A plane that leans over "
    "backwards is written by the other side: 95 toward 115 is 85 toward 295.",
    "E102": "A dip direction is a bearing clockwise from north, 0 to 360: the way a ball would roll down the plane.",
    "E103": "The first number is larger than any dip and the second would fit one: 115/45 instead of 45/115. "
    "slopekit always takes dip / dip direction.",
    "E104": "A plane is two numbers with a slash: 45/115. Strike notations (N25E 45SE, 025/45 by strike) are not "
    "taken, because their conventions differ: by the right-hand rule, dip direction = strike + 90.",
    "E105": "A value is infinite or not a number. Look for a division by zero where the input was made.",
    "E106": "A number is needed here, with a unit behind it or without.",
    "E107": "The unit measures something else: a pressure where a length is needed, or a density for a unit weight. "
    "Bare numbers are m, kN, kPa, kN/m³ and degrees.",
    "E108": "slopekit does not know this unit; the message lists those it knows for this kind of value.",
    "E109": "Something is missing, or there are more values than things: a wedge has two joints, a point three "
    "coordinates, and c, φ and u take one value for both joints or two.",
    "E110": "Unit weight is a weight per volume in kN/m³: rock has 20 to 30. 2650 is a density in kg/m³, 2.65 one in "
    "t/m³: give those as a density.",
    "E111": "Density is a mass per volume in kg/m³: rock has 2000 to 3000. Write '2.65 t/m3' or 2650; 26 is a unit "
    "weight in kN/m³.",
    "E112": "Density and unit weight say the same thing: γ = ρ g. Give one, so that they cannot contradict each other.",
    "E113": "Friction angles are in degrees. A fraction below 1.57 is almost surely in radians; if you mean a joint "
    "of nearly no friction, write 0 or a whole number.",
    "E114": "A strength is zero or more.",
    "E115": "A friction angle lies from 0 to below 90 degrees; joints have 15 to 45.",
    "E116": "The height is vertical, from the toe to where the trace of joint 1 meets the crest, and more than 0.",
    "E117": "Dilation is how much a joint opens as it slips. It lies between 0 and the friction angle: beyond that a "
    "joint would give back more work than it takes.",
    "E118": "100 % is full water: the classic pyramid with mean pressure γ_w H/6 on each joint. For more, give the "
    "pressures themselves: u=12kPa or u=12kPa,8kPa.",
    "E119": "Water is dry, full, a percentage of full, or mean pressures on the joints. Suction is not modelled.",
    "E120": "A tension crack is written plane@distance: 80/180@5m; the distance runs from the crest along the trace "
    "of joint 1 on the upper slope.",
    "E121": "The distance of the crack from the crest is more than 0.",
    "E122": "The pseudo-static coefficient is the part of gravity that acts sideways; K@TREND gives its direction, "
    "else it acts along the trend of the line of intersection.",
    "E123": "A force is written size@trend/plunge (plunge positive downward), or as three numbers east, north, up.",
    "E124": "A bolt is written T@TREND/PLUNGE with the direction of its force on the wedge, then active (a load) or "
    "passive (strength: its capacity is divided by the factor of safety). Its length is measured from its head.",
    "E125": "A slip surface is divided into at most 12 000 triangles, or the solver would take minutes. The default "
    "edge gives four digits of the factor; the error falls with the square of the edge.",
    "E126": "limit is the largest factor at which the wedge still stands; all-pairs adds the paper's criterion, the "
    "smallest factor at which every node pair slips or debonds, which depends on the joint stiffness.",
    "E127": "An acceptance level and a tolerance are more than 0.",
    "E128": "This is not an input of a wedge. The message names the nearest one there is.",
    "E129": "The folder or file cannot be written. Nothing was computed yet, nothing is lost.",
    "E130": "Gravity is more than 0.",
    "E131": "refine is how often each triangle of the joints is split in four, a whole number. Flat joints need none: "
    "slopekit refines by itself where moments open part of a joint.",
    "E132": "A stiffness is more than 0, in kN/m³ (kPa per metre); the shear stiffness may be clough-duncan.",
    "E133": "An option that takes one value was given twice. --force and --bolt may be repeated, the others may not.",
    "E140": "Drawing needs the extra `plot`: in slopekit's folder, pip install '.[plot]'.",
    "E141": "Pictures are written as PNG: give a file name that ends in .png.",
    "E142": "A design of this kind has no such key here. The message names the nearest one, or the place where the key "
    "belongs. Keys are written in lower case; a colon needs a space behind it: phi: 20.",
    "E143": "A key that this kind of design needs is not there. `slopekit templates show wedge` prints a whole design.",
    "E144": "The value has the wrong shape: keys of its own where one value is needed, one value where keys are, or no "
    "list where a list is. Any number may be a distribution: {dist: normal, mean: 20, sd: 2}.",
    "E145": "The key is there and nothing behind it. Give it a value, or leave the key out.",
    "E146": "Strengths, joints and blocks have names of your choice, without dots and slashes: those join names "
    "elsewhere, as in J1.phi/J2.phi.",
    "E147": "There is no such file. The message names the nearest one in that folder.",
    "E148": "The path is a folder, or the system does not let slopekit read the file.",
    "E149": "Design files and joint lists have at most 5 MB, 100 000 values and 100 levels. Meshes stand in files of "
    "their own. A design that is nested this deep usually has a bracket left open.",
    "E150": "The file is not YAML 1.2. Line and column say where reading stopped; the slip is there or just above it: "
    "a bracket or quote left open, a tab, keys of one level indented differently, a ': ' inside text without quotes.",
    "E151": "A key may stand once in its group, and --set may set a path once: of two values one would be dropped.",
    "E152": "The merge key << belongs to YAML 1.1. An alias (*name) for one whole value is taken; several keys are "
    "written out.",
    "E153": "Tags (!name) make YAML build objects of programs. A design has only texts, numbers, lists and keys. Text "
    "that starts with ! goes in quotes.",
    "E154": "An alias (*name) stands inside what it names, or aliases of aliases write out more than 50 000 values. In "
    "Python: a dict or list contains itself.",
    "E155": "A file holds one design. A line --- starts a second one.",
    "E156": "The file holds nothing but blanks and comments.",
    "E157": "A design is a group of keys with values: slopekit: 1, kind: wedge, and so on.",
    "E158": "A key is a name. Here it is empty, a list, or has keys of its own: often a ? or a colon too many.",
    "E159": "The file is not UTF-8 text, or holds a control character. In an editor: save as UTF-8. Joint lists may "
    "also be UTF-16 or Windows text.",
    "E160": "--set takes a dotted path, an equals sign and a value: --set strength.weak.phi=25. Lists and groups are "
    "written in brackets, in quotes for the shell: --set 'slope.profile=[[0, 0], [10, 5]]'.",
    "E161": "The path goes on behind a single value. Set that value as a whole: slope.face=65/180.",
    "E162": "Items of a list are named by their number, from 0: support.bolts.0.force. --set changes items that are "
    "there; to add or remove one, set the whole list.",
    "E163": "From Python a design takes what a file could hold: numbers, texts, lists, dicts, arrays, Plane, Line "
    "and paths.",
    "E164": "The list or group has too few or too many entries: a point of a profile "
    "has two coordinates, a wedge two joints.",
    "E165": "Known distributions are normal, lognormal, uniform, triangular, and fisher for orientations. min and max "
    "truncate the first two.",
    "E166": "Orientations scatter by fisher: {dist: fisher, mean: 45/115, k: 100}, k above 0, larger is tighter. "
    "Numbers take one of the others.",
    "E167": "Correlation is given by pairs of names with a slash: J1.phi/J2.phi: 0.8.",
    "E168": "Only values that are distributions can be correlated. The message names the nearest, or lists them.",
    "E180": "A correlation coefficient lies between -1 and 1.",
    "E181": "A/B and B/A are the same pair.",
    "E182": "Every value has the correlation 1 with itself.",
    "E183": "Not every set of coefficients is possible: if A goes with B and B with C, A cannot go against C. The "
    "correlation matrix must have no negative eigenvalue. The message gives the largest factor that makes it possible.",
    "E184": "The distribution lacks a parameter: normal and lognormal have mean and sd, uniform min and max, "
    "triangular min, mode and max, fisher mean and k.",
    "E185": "This distribution has no such parameter. Only normal and lognormal have a mean with min and max.",
    "E186": "A standard deviation is 0 or more, in the unit of the value. 0 makes the value certain.",
    "E187": "The lower bound must lie below the upper one.",
    "E188": "The mean or mode lies outside min and max. The mean is that of the distribution before it is truncated.",
    "E189": "Lognormal values are more than 0, and so is their mean. Give mean and sd of the value itself, not of its "
    "logarithm.",
    "E190": "The list has no row with a joint. The first line names the columns, each further line is one joint.",
    "E191": "A joint list needs the columns dip and dip_direction (also dd, dipdir, azimuth), each once, in degrees, "
    "separated by comma, semicolon or tab. Two columns of numbers without a header are dip and dip direction.",
    "E192": "A strike says which way a plane dips only by a convention. right-hand-rule: dip direction = strike + 90; "
    "left-hand-rule: strike - 90.",
    "E193": "The row has more values than there are columns, or lacks one. Decimal commas need semicolons or tabs "
    "between the columns.",
    "E194": "Each joint has a name of its own. A column `id` or `name` is taken before a column `set`.",
    "E201": "Parallel joints never meet in a line, so they form no wedge. If they are one set, look at plane failure.",
    "E203": "The line of intersection must come out of the face above the toe: it has to plunge less than the face "
    "does in the same direction. A steeper line stays inside the rock: no wedge can slide out.",
    "E204": "The line of intersection plunges into the slope: whatever the joints form cannot slide out of the face.",
    "E205": "The line of intersection must climb out of the upper slope behind the crest: it has to plunge more than "
    "the upper slope does in the same direction.",
    "E206": "A joint parallel to the face or with a trace that never meets the crest bounds no wedge with it.",
    "E207": "The tension crack must cross the line of intersection between the toe and the back of the wedge.",
    "E208": "No piece of the cut rock mass touches both joints and the face and is free of the rock behind.",
    "E209": "Face and upper slope must meet in a crest above the toe.",
    "E211": "A bolt must pass through the wedge and be anchored behind one of its joints.",
    "E212": "A bolt must reach past the deepest joint, with its anchorage length on top.",
    "E501": "The control areas of the node pairs must sum to the interface. This is a bug of ours: please report it.",
    "E502": "There is nothing to solve.",
    "E503": "A rigid translation moved node pairs by the wrong amount. This is a bug of ours: please report it.",
    "E599": "A bug of ours. SLOPEKIT_DEBUG=1 prints where it happened.",
    "W301": "Nearly parallel joints: a degree on either moves the line of intersection far, and the wedge with it.",
    "W302": "The unit weight is far from that of rock. If you work in other consistent units, this is why.",
    "W303": "The closed form balances forces only. Here the moments open part of a joint or turn the wedge at a lower "
    "factor: that lower factor is the answer.",
    "W305": "The wedge was computed about its toe; map coordinates were added back at the end.",
    "W306": "On an elastic bed part of the joints carries no normal force at the limit. In rigid sliding nothing opens "
    "there, so its cohesion is counted, as Hoek & Bray count it. If that part may be open, leave it out of c.",
    "W307": "A joint loses its cohesion where it opens, at once: the factor of safety jumps there. A little less "
    "water or a little more bolt force may close it again.",
    "W308": "Joints without cohesion and friction hold nothing. A factor of 0 says nothing: the status stands.",
    "W309": "The solver for the static bound gave up, there are more than 7500 node pairs, or the bound is more than a "
    "thousand times the limit (a block that cannot dilate its way out is locked). The limit does not depend on it.",
    "W310": "Hoek & Bray's wedge slides without dilating. With dilation its number is printed but not compared.",
    "W311": "Without a head a bolt's line of action is not known: it is taken through the centroid.",
    "W312": "Where moments open part of a joint the answer depends on the node pairs; this is how much the last "
    "refinement still moved it. --refine N goes on.",
    "W313": "The limit is above 1, yet on an elastic bed no equilibrium was found at full strength: pairs that open "
    "there lose their cohesion one after the other, or Newton's method lost its way. Displacements are not given.",
    "W315": "A passive bolt acts only when the wedge draws it out. These are square to the movement or pushed in.",
    "W318": "Bolts or forces are stronger than what drives the wedge down. The factor says how far it is from being "
    "pushed up the slope; more of the same force makes it smaller.",
    "W319": "With mean pressures each surface has its own: u=5kPa,8kPa,20kPa gives J1, J2 and the crack.",
    "W317": "What opens and what holds kept trading places between the passes (mostly in a wedge on its edges). "
    "The lowest factor they came to is printed, with the range; the answer is no surer than that.",
    "W328": "A seismic load is meant to drive the block. Its trend is where it pushes the rock: out of the slope. On a "
    "surface below a profile x is east (090) and -x west (270).",
    "W329": "A joint that opens has lost its tensile strength, so the limit and the closed forms count none of it. It "
    "acts in the displacements and in the all-pairs criterion.",
    "W330": "On a curved surface the factor rests on how the normal stresses are taken. The methods of columns take "
    "them otherwise; a rule may name them: fos.bishop >= 1.3.",
    "W331": "Give the profile as far as the slip surface reaches.",
    "W332": "The block may fail below its static bound. Judge by fos, and use the bound to see how far it can be off.",
    "W316": "Joints have 0 to a few hundred kPa of cohesion. 50000 is 50 kPa typed in Pa: write '50000 Pa' or 50.",
    "E169": "An acceptance rule compares fos, fos.limit, fos.closed_form, fos.static_bound, fos.all_pairs_failed or "
    "(on surfaces) fos.fellenius, fos.janbu, fos.bishop, fos.all_equilibrium with a number: fos >= 1.5.",
    "E170": "A slip surface is an ellipsoid (centre, radii), a sphere (centre, radius), a horizontal cylinder along y "
    "(centre, radius, length) or a mesh. Its normals are true (analytic), smoothed (meshes) or facet (a study).",
    "E171": "A radius, a length and an edge are more than 0.",
    "E172": "A mesh is an STL, OBJ, PLY, OFF or GLB file beside the design, of at most 400 000 triangles.",
    "E173": "Pictures are drawn of wedges; the other kinds follow.",
    "E174": "The first key of a design file says which version of the language it is written in: slopekit: 1.",
    "E175": "kind says what the design is: wedge, plane, footing or surface.",
    "E176": "Each interface has one of the strengths under strength. With one strength it need not be named.",
    "E177": "`slopekit templates list` shows the templates there are.",
    "E178": "The file of a new design is there already; slopekit does not write over it.",
    "E195": "A strength that no interface uses is mostly a slip in a name.",
    "E196": "The displacements and the all-pairs criterion take one stiffness for all joints. The limit factor and "
    "the closed forms do not depend on it.",
    "E197": "The name is not among those of the design or of the joint list.",
    "E198": "The water is said twice. Give mode, fill or pressures; in a crack either its own word or that of water.",
    "E199": "Node pairs along a line follow Simpson's rule: an odd number from 3 to 2001.",
    "E213": "Plane failure is a section: the plane has to strike within 20 degrees of the face. Otherwise look at a "
    "wedge with another joint.",
    "E214": "The slip surface has to cut a piece off the ground and to come out at the ground surface.",
    "E215": "A slip surface that ends within the ground would leave the mass hanging on walls that are not modelled.",
    "E216": "A body to cut has to be closed, without holes, not cross itself, its triangles turned outward.",
    "E217": "An open sheet is taken as the floor of the sliding mass: it must lie over its plan once.",
    "E218": "The profile is the ground surface as x, z in order, from one side to the other.",
    "E219": "The load of a footing stands on the top of the block, between the face and the end of the weak plane.",
    "W320": "`run` takes one value of each distribution, its mean. `prob` draws them all.",
    "W321": "Plane failure is computed in the section square to the face; a plane that strikes a little differently is "
    "taken by its true dip.",
    "W322": "Within the slip surface lie several pieces of ground that do not touch; only the largest is analysed.",
    "W323": "A section carries only what acts in it.",
    "W324": "Fellenius, Janbu, Bishop and the method of all equilibrium are computed for one mass on an analytic "
    "surface under weight, seismic along the profile and water pressure. The message says what is left out and why.",
    "W325": "Only spheres, cylinders and surfaces of revolution let a rigid mass slip without opening. For others the "
    "normals are turned square to the motion that comes nearest, by the angle given; far from it the mass must dilate.",
    "W326": "With each facet's own normal a mass interlocks with its surface. Use true or smoothed normals.",
    "W327": "What a joint list holds beside its joints, and strengths of the design where the list has its own.",
}  # fmt: skip


def explanation(code: str) -> str:
    """The long text of a code.

    Raises
    ------
    DesignError
        E128 for a code that does not exist.

    >>> explanation("e203").splitlines()[0]
    'E203'
    """
    wanted = code.strip().upper()
    if wanted not in EXPLANATIONS:
        digits = wanted[:1] + wanted[1:].replace("O", "0").replace("I", "1").replace("L", "1")
        near = [digits] if digits in EXPLANATIONS else get_close_matches(wanted, EXPLANATIONS, n=1)
        advice = f"Did you mean {near[0]}?" if near else ""
        raise DesignError([Fault("E128", f"{code} is not a code of slopekit", "", advice)])
    return f"{wanted}\n{EXPLANATIONS[wanted]}"
