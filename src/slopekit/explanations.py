"""The long text of every code, for `slopekit explain CODE`. Loaded only when asked for."""

from collections.abc import Mapping
from difflib import get_close_matches

from slopekit.errors import DesignError, Fault
from slopekit.exchange_explanations import EXCHANGE
from slopekit.study_explanations import STUDIES

EXPLANATIONS: Mapping[str, str] = {
    **STUDIES,
    **EXCHANGE,
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
    "E134": "The spacing of a joint set is the distance between its planes, square to them, and more than 0.",
    "E135": "scatter is the standard deviation of the angle between a joint and its set's plane, 0 to 45 degrees; "
    "spacing_scatter that of the distances, 0 to 100 % of the spacing.",
    "E136": "Two sets with the same orientation, spacing and offset are the same planes twice.",
    "E137": "Counts are whole numbers: mechanisms 1 to 1000, max_blocks 1 to 200 000, seed from 0, rows from 1.",
    "E138": "min_volume is the smallest block that is kept as one of its own; smaller ones are joined to a neighbour.",
    "E139": "The columns of a toppling slope dip into it, more than 0 and less than 90 degrees. The base of each "
    "dips 90° less that angle out of the slope.",
    "E140": "Drawing, and reading VTU, needs the extra `plot`, DXF the extra `cad`: in slopekit's folder, "
    "pip install '.[plot,cad]'.",
    "E141": "Charts are written as .png, .svg or .pdf, the scene of a result as .png, .glb or .gltf: the end of "
    "the file name says which.",
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
    "E149": "Design files and joint lists have at most 5 MB, 200 000 values (five numbers of a list count as one) and "
    "100 levels. Meshes stand in files of their own. A design nested this deep usually has a bracket left open.",
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
    "E161": "The path goes on behind a single value. Set that value as a whole: slope.face=65/180. The dip of a plane "
    "can be set by itself (slope.face.dip=65) unless the plane scatters as a whole, by fisher.",
    "E162": "Items of a list are named by their number, from 0: support.bolts.0.force. --set changes items that are "
    "there; to add or remove one, set the whole list.",
    "E163": "From Python a design takes what a file could hold: numbers, texts, lists, dicts, arrays, Plane, Line "
    "and paths.",
    "E164": "The list or group has too few or too many entries: a point of a profile "
    "has two coordinates, a wedge two joints.",
    "E165": "Known distributions are normal, lognormal, uniform, triangular, and fisher for orientations. min and max "
    "truncate the first two.",
    "E166": "Orientations scatter by fisher: {dist: fisher, mean: 45/115, k: 100}, k above 0, larger is tighter. "
    "Numbers take one of the others, and so do the angles of an orientation: "
    "{dip: {dist: normal, mean: 45, sd: 3}, dip_direction: 115}.",
    "E167": "Correlation is given by pairs of names with a slash: J1.phi/J2.phi: 0.8. It is that of the ranks "
    "(Spearman), and pairs that are not given have none.",
    "E168": "Only values that are distributions can be correlated. The message names the nearest, or lists them.",
    "E180": "A correlation coefficient lies between -1 and 1.",
    "E181": "A/B and B/A are the same pair.",
    "E182": "Every value has the correlation 1 with itself. Two joints that share a strength share its φ: give each a "
    "strength of its own where they shall scatter apart.",
    "E183": "Not every set of coefficients is possible: if A goes with B and B with C, A cannot go against C. Values "
    "are drawn by normals with the correlation 2 sin(π ρ / 6), whose matrix must have no negative eigenvalue. The "
    "message gives the nearest coefficients that can be, by the Frobenius distance of those matrices (Higham 2002), "
    "rounded so that they can be typed in as they stand. Pairs that are not given count as 0 and stay so: c and φ of "
    "two joints with c/c and φ/φ correlated often need the cross pairs J1.c/J2.phi too.",
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
    "E212": "A bolt must reach past the deepest joint, with its anchorage length on top. In an assembly a passive bolt "
    "must not end in the block of its head; where it ends in another that can move, it ties the two.",
    "E501": "The control areas of the node pairs must sum to the interface. This is a bug of ours: please report it.",
    "E502": "There is nothing to solve.",
    "E503": "A rigid translation moved node pairs by the wrong amount. This is a bug of ours: please report it.",
    "E371": "A report is the page of one result, with its blocks, forces and check. Studies (check, sweep, prob) are "
    "drawn by `slopekit plot` and have sheets of their own.",
    "E372": "Something that every result holds is missing or is not what it should be: the file was changed, cut off "
    "or written by another version. Make it again with `slopekit run DESIGN -o DIR`.",
    "E373": "A report is a page of HTML: give a file name that ends in .html, or a folder.",
    "E599": "A bug of ours. SLOPEKIT_DEBUG=1 prints where it happened.",
    "W371": "The words of the sheet stand in the JSON that the commands write, not in `to_dict()`. Give `sk.report` "
    "the result itself, or make the JSON with `slopekit run DESIGN -o DIR`.",
    "W372": "The page is whole but for the view that can be turned: the `scene` of the JSON is missing or damaged.",
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
    "W309": "The solver for the static bound gave up, there are too many node pairs or blocks for it (7500 pairs of "
    "one block, 600 blocks in space as a rule), or the bound is more than a thousand times the limit (what cannot "
    "dilate its way out is locked). The limit is then held against no upper bound. The path of many blocks starts "
    "elsewhere without it.",
    "W310": "Hoek & Bray's wedge slides without dilating. With dilation its number is printed but not compared.",
    "W311": "Without a head a bolt's line of action is not known: it is taken through the centroid.",
    "W312": "Where moments open part of a joint, or a contact in space twists, the answer depends on the node pairs; "
    "this is how much the last refinement still moved it. --refine N goes on (one block).",
    "W313": "The limit is above 1, yet on an elastic bed no equilibrium was found at full strength: pairs that open "
    "there lose their cohesion one after the other, or Newton's method lost its way. Displacements are not given.",
    "W314": "The collapse motion opens part of a joint that has cohesion. Three rules say what is left of it. Cracked "
    "base: on an elastic bed what is in tension at the limit has none, what is pressed has all of it, as dams are "
    "judged. Bond gone: a joint that the motion opens anywhere loses all of it. By mechanism: what the motion opens, "
    "pair by pair of nodes; finer pairs lower it to bond gone. The limit is the lower of the first two. The line "
    "COHESION has all three, the pressed share of each joint, where its force acts and where it opens on the bed.",
    "W315": "A passive bolt acts only when the movement draws it out. These are square to it or pushed in; of many "
    "blocks it is the first mechanism that counts.",
    "W318": "Bolts or forces are stronger than what drives the wedge down. The factor says how far it is from being "
    "pushed up the slope; more of the same force makes it smaller.",
    "W319": "With mean pressures each surface has its own: u=5kPa,8kPa,20kPa gives J1, J2 and the crack.",
    "W317": "One block: what opens and what holds kept trading places between the passes (mostly in a wedge on its "
    "edges); the lowest factor they came to is printed, with the range. Many blocks: the motion did not settle, and "
    "the factor is that of the last state at rest, the peak of the elastic path: it may be too high. Where random "
    "sections had both, the limit lay up to 4 % below the peak; in space that was not measured. The sheet says how "
    "much higher the blocks run. With curved strength: no limit state has the strength of its own tractions; the "
    "lowest factor of those that trade places is printed.",
    "W328": "A seismic load is meant to drive the block. Its trend is where it pushes the rock: out of the slope. On a "
    "surface below a profile x is east (090) and -x west (270).",
    "W329": "A joint that opens has lost its tensile strength, so the limit and the closed forms count none of it. It "
    "acts in the displacements and in the all-pairs criterion.",
    "W330": "On a curved surface the factor rests on how the normal stresses are taken. The methods of columns take "
    "them otherwise; a rule may name them: fos.bishop >= 1.3.",
    "W331": "Give the profile as far as the slip surface reaches.",
    "W332": "The block may fail below its static bound. Judge by fos, and use the bound to see how far it can be off.",
    "W316": "Joints have 0 to a few hundred kPa of cohesion. 50000 is 50 kPa typed in Pa: write '50000 Pa' or 50.",
    "E169": "An acceptance rule compares fos, fos.limit, fos.closed_form, fos.static_bound, fos.all_pairs_failed, "
    "fos.lowest or (on surfaces) fos.fellenius, fos.janbu, fos.bishop, fos.all_equilibrium with a number: fos >= 1.5.",
    "E170": "A slip surface is an ellipsoid (centre, radii), a sphere (centre, radius), a horizontal cylinder along y "
    "(centre, radius, length) or a mesh. Its normals are true (analytic), smoothed (meshes) or facet (a study).",
    "E171": "A radius, a length and an edge are more than 0.",
    "E172": "A mesh is an STL, OBJ, PLY, OFF, GLB or DXF file beside the design, of at most 400 000 triangles; DXF "
    "needs the extra `cad`.",
    "E350": "Scenes are made of the blocks, interfaces and node pairs that result.json keeps under `scene`, packed. "
    "The file has none (that of a study, or of an older slopekit), or they were changed: slopekit run DESIGN -o DIR.",
    "E351": "The displacement at full strength, on the elastic bed of the joints, is found for blocks that stand "
    "there, up to 300 of them. For a slope that fails draw the mechanism.",
    "E352": "Nothing moves, so there is no mechanism to draw: the blocks stand without any strength, or the analysis "
    "did not converge.",
    "E353": "Mechanisms are counted from 1 in the order in which they happen. `analysis: {mechanisms: N}` in the "
    "design asks for more of them.",
    "E354": "--explode is in parts of the distance of a block from the middle, --magnify times the displacement: "
    "numbers of 0 or more.",
    "E174": "The first key of a design file says which version of the language it is written in: slopekit: 1.",
    "E175": "kind says what the design is: wedge, plane, footing, surface, topple, bench or blocks.",
    "E176": "Each interface has one of the strengths under strength. With one strength it need not be named.",
    "E177": "`slopekit templates list` shows the templates there are.",
    "E178": "The file of a new design is there already; slopekit does not write over it.",
    "E179": "In designs of many blocks water is dry or given by its mean pressures on the interfaces: those of a joint "
    "set (S1: 5 kPa), of base and sides of columns, or of a pair of blocks (B1/B2: 5 kPa).",
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
    "E240": "Width, height and thickness of columns and blocks are more than 0.",
    "E241": "base_step is how much the base of each column lies above that of the one below, square to the base. A "
    "step as high as a column would leave it no neighbour to lean on.",
    "E242": "A polygon goes once around its block, either way, without crossing or touching itself, and encloses an "
    "area. The first point may be repeated at the end.",
    "E243": "Blocks are all polygons (x, z) of one section, with its thickness, or all closed meshes. A block is "
    "one or the other.",
    "E244": "fixed is true for bedrock, and false (or left out) for blocks that may move.",
    "E245": "Blocks without bedrock would fall for ever. One that is fixed carries the others: "
    "base: {polygon: [...], fixed: true}.",
    "E246": "At least one block has to be free to move.",
    "E247": "Interfaces have the names of their two blocks with a slash, either way round: B1/B2.",
    "E248": "B1/B2 and B2/B1 are the same interface.",
    "E249": "Where there are several strengths, interfaces that are not named need one: interfaces: {default: joint}.",
    "E250": "A force or bolt acts on a block that moves. Columns are named C1, C2, ... from the toe upward, in several "
    "rows C1-1 (column 1 of row 1), C1-2, ...",
    "E251": "With several blocks a load says which one it acts on: block: B1. In a bench, whose blocks are cut later, "
    "a force may give a point in its block (at:), a bolt its head.",
    "E252": "Columns and polygons are a section in x (east) and z (up): forces and bolts act in it, toward 090 or 270 "
    "with any plunge. For loads along y give the blocks as meshes.",
    "E253": "A seismic load acts toward 090 or 270 in a section. Columns slide toward 270 and benches toward the dip "
    "direction of the face; the user's own blocks do not say which way they fall.",
    "E254": "Faces nearer than contact_tolerance touch: a length, more than 0, and small beside the blocks.",
    "E260": "Columns and blocks have sizes above 0, friction angles from 0 to below 90 degrees and no negative "
    "cohesion; each column of a stepped base is higher than the step to the next.",
    "E261": "An active block pushes a passive one only where its base dips more than that of the passive block.",
    "E262": "An earthquake or a toe force that lifts a column off its base leaves the theory of toppling columns.",
    "E227": "The corners of a block go round it once. Where the outline crosses or touches itself the list has two "
    "corners exchanged, or one block is two: give each its own outline. A hole is cut by splitting the block.",
    "E228": "A block needs an area (a polygon) or a volume (a mesh): at least three corners not on one line, "
    "or the triangles of a closed surface, all coordinates finite.",
    "E229": "A block's mesh has to be closed: each edge between exactly two triangles, all of them anticlockwise seen "
    "from outside. A mesh that is wholly inside out is turned. Repair it in the program that made it: fill holes, "
    "unify normals, one body per mesh.",
    "E230": "Faces nearer than the contact tolerance touch. It has to be much smaller than the smallest block; leave "
    "it out for 1e-5 of the mean block size.",
    "E231": "Columns have heights, a width and a thickness of more than 0, and dip into the slope by more than 0 and "
    "up to 90 degrees: 90 is upright on a level base.",
    "E220": "The number of blocks grows with the third power of 1 / spacing, time and memory with the number of blocks "
    "(about 0.1 ms and 10 kB each to cut). Blocks much smaller than the mechanism you look for add little: take larger "
    "spacings, a shorter or lower bench, or raise max_blocks.",
    "E221": "The face of a bench dips between 1 and 90 degrees. An overhanging face is cut by kind: blocks.",
    "E222": "The upper slope starts at the crest and has to stay above the level of the toe, as far as the bench is "
    "modelled, and to be flatter than the face.",
    "E223": "Height, length and depth of a bench are more than 0.",
    "E224": "The volumes of the blocks must sum to the bench, each joint face must have its other side, and corners "
    "must lie on their planes. This is a bug of ours: please report it. Another offset of a joint set may avoid it.",
    "E225": "Blocks smaller than min_volume are joined to neighbours; nothing is left when the whole bench is smaller.",
    "E270": "check looks at one design file, or with --suite at the published and exact cases that slopekit ships.",
    "E271": "The suite is fixed: its inputs are those of its sources. Copy a case to a file of your own to change it.",
    "E273": "A chart needs factors of safety: a design that is lifted, falls or stands without strength has none, and "
    "a contour needs three at least. Its sheet and JSON are written all the same.",
    "E272": "The suite knows cases by their id, the sources they come from and the kinds of designs; the message names "
    "those nearest to what was typed. Leave the choice out to run them all.",
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
    "E256": "Every block reaches an outer face of the model, behind which the rock goes on, or is named fixed: "
    "nothing is left that could move. Closer joints, or a longer and deeper bench, give blocks that are "
    "free.",
    "E257": "Two blocks of the design lie in each other. Where they do, their faces do not meet and carry "
    "nothing, so no factor of safety would mean anything. Overlaps below a thousandth of the smaller "
    "block are reported and left (W333).",
    "E504": "The stiffness of so many blocks in space does not fit into memory. Take fewer or larger "
    "blocks, or a shorter bench.",
    "E505": "The equations of the blocks could not be factorised. This is a bug of ours: please report it with "
    "the design.",
    "E506": "The environment variable SLOPEKIT_KERNELS is numpy (the compiled kernels of many blocks stay unused), "
    "compiled (they have to be there) or not set (they are used where they are). They are compiled when "
    "slopekit is installed where there is a C compiler.",
    "W333": "Blocks overlap by less than a thousandth of the smaller one. Faces beyond the tolerance do not "
    "touch: see whether contacts are missing.",
    "W334": "Faces of two blocks are parallel and nearly touch, but lie farther apart than the contact tolerance: "
    "they carry nothing. Move the corners, or give contact_tolerance.",
    "W335": "A strength or a water pressure is given for two blocks that share no contact.",
    "W336": "Cells smaller than cut.min_volume (at least 1e-9 of the bench) are joined to the neighbour with "
    "which they share the largest face, so that no sliver governs the answer.",
    "W337": "Planes of the sets that lie on each other, or on a face of the bench, within 1e-6 of its size are "
    "one plane.",
    "W338": "Blocks at the ends, the back and the bottom are held, because the rock goes on there. Where the "
    "mechanism touches them, the size of the model may matter: make it longer or deeper and compare.",
    "W340": "Goodman & Bray's method does not cover this design, or its forces are not admissible: the table may "
    "be shown, it is not compared.",
    "W341": "The static bound lets joints dilate with their reduced friction angle; where it lies far above the "
    "limit, blocks lock by dilation that real joints at large slip do not have. Programs that assume "
    "normality give the bound.",
    "W342": "Two blocks touch in a corner, with no edge or face in common. Such a contact has no area and carries "
    "nothing.",
    "W343": "The triangles of a mesh were ordered the wrong way round: its volume came out negative. It was "
    "turned.",
    "W344": "One mesh file holds several closed surfaces. They are one rigid block: give each its own file if "
    "they are not.",
    "W345": "A mesh that crosses itself cannot be intersected with its neighbours: whether they overlap is not "
    "known.",
    "W361": "When all loads came on at once the blocks came to rest at none of the strengths tried, or their motion "
    "did not settle. Weight and water came on first then, earthquake and forces after them, at one strength after the "
    "other, and the factor is that of a strength at which they just all fit on: a limit state as well, of another "
    "order of loads. It may depend on that order.",
    "W362": "With earthquake and forces coming on last, after weight and water, the blocks failed before all of them "
    "acted, at five strengths from just above that of the static bound to ten times as much: mostly they tip or are "
    "pushed off, which friction does not hinder. That more strength would not do is likely, not proved. The message "
    "says what part of these loads they carry at full strength; `slopekit solve` finds it for a factor of 1. The "
    "static bound is no answer then: it counts forces that lock blocks.",
    "W363": "Forces that balance the loads may exist, yet the blocks did not come to rest when gravity came on, on "
    "elastic joints, at twice the strength of the static bound and more, or only where they jam at more than eight "
    "times that strength. Leaning columns and walls do so: they tip, which friction does not hinder. It was tried, "
    "not proved.",
    "W364": "The limit of many blocks is that of elastic joints with k_t / k_n 0.4. For most slopes any ratio gives "
    "the same; `check` tries 0.1 and 1 and calls the limit consistent only if both stay within 1 %, as 93 % of 683 "
    "random sections did. Where it moves further, forces that are locked in between the blocks decide, and nobody "
    "knows them: judge by the range of the mechanism (fos.lowest). Not known: with another ratio the search found no "
    "limit.",
    "W346": "A block that shares no contact with any other falls if it is not fixed; the factor of safety of the "
    "others does not depend on it.",
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
