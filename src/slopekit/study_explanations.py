"""The long texts of the codes that design studies use: sampling, prob, sweep, solve, support, combos, kinematic."""

from collections.abc import Mapping

STUDIES: Mapping[str, str] = {
    "E280": "A study reads the design again with other values, so it needs the file, or the dict, that it came from. "
    "A wedge made by `sk.wedge(...)` has neither: write it as a design file or as a dict for `sk.load`.",
    "E281": "More than 1 % of the distribution lies where no design can be: cohesion below 0, a friction angle of 90° "
    "and more, water beyond full. Cutting it off without a word would change what was asked for: add min or max, which "
    "truncate it. Smaller shares are drawn, counted as impossible and said.",
    "E283": "An orientation has two angles, so a pair says which: J1.plane.dip/J1.phi. Two orientations may be paired "
    "as a whole, which means both angles: J1.plane/J2.plane. The two angles of one Fisher plane are independent.",
    "E300": "`--jobs N` works on N processes of this machine, `--scheduler` hands the work to a Dask cluster: one or "
    "the other. Results do not depend on either.",
    "E301": "Nothing answered at the address, or no worker is there. `dask scheduler` prints its address when it "
    "starts; each machine that shall work runs `dask worker` with that address and has slopekit installed.",
    "E302": "`prob` draws the numbers of a design that are distributions, and this one has none. Write a number as "
    "{dist: normal, mean: 20, sd: 2} (lognormal, uniform, triangular; min and max cut it off), an orientation as "
    "{dist: fisher, mean: 45/115, k: 100}.",
    "E307": "A number of samples, a seed, a target, a confidence or a probability lies outside what makes sense; the "
    "message names its limits.",
    "E308": "The message lists the words that are known. Only wedges, planes and footings have a closed form that can "
    "stand for PRE-IE in thousands of samples.",
    "W350": "A distribution without bounds reaches values that nothing can have: a negative cohesion, a friction angle "
    "beyond 90°. Such samples count neither as failures nor among all. More than 1 % of them is refused (E281).",
    "W351": "Samples without an answer could be failures. Where they are many, the probability says little.",
    "W352": "With few failures the estimate itself is hardly more than a guess; the upper confidence limit is what the "
    "samples prove. Ten times the samples give a third of the width.",
    "W353": "The closed form knows forces only. Where moments govern, the true factor lies lower, by up to tens of per "
    "cent: take `--by pre-ie`, or its probability in the sheet.",
    "W354": "These samples stand by the closed form and fail by PRE-IE, moments included. The sheet gives the "
    "probability with PRE-IE's judgement: its own where it was asked, that of the random part for the rest.",
    "E303": "Worker processes were killed over the same tasks three times, without any being finished in between. Most "
    "often the system stops them for want of memory: fewer jobs, or smaller models. In a script of your own, studies "
    "with jobs have to be called below `if __name__ == '__main__':`, as for every pool of processes.",
    "E304": "The run was interrupted. The samples, points or pairs that were done stand in the journal; the same "
    "command finds them and goes on from there. A journal is of one run: with other inputs, another seed or another "
    "version of slopekit a run starts anew.",
    "E305": "Handing work to a cluster needs the library Dask: pip install 'slopekit[dask]'.",
    "E306": "Workers with another version of slopekit could give other numbers, and a worker without it none.",
    "E330": "Pairs grow with the square of the joints: 3000 make 4.5 million. Take one structural domain of the slope "
    "at a time, or a sample of each set.",
    "E331": "`combos` looks at pairs of joints, so the list needs two of them.",
    "E332": "Every joint of a pair needs a strength: the columns c and phi of the list count where they are filled, --c"
    " and --phi for all others. The message names the joints that have neither.",
    "E333": "`--faces FROM:TO:STEP` goes through dips of the face, 45:90:5; in Python a list will do. A face dips more "
    "than 0 and up to 90°, and there are at most 200 of them.",
    "E334": "A limit of size is a length (persistence, bench width) or a volume above 0, and the least volume is not "
    "more than the largest. Wedges larger than persistence, bench width or max volume are scaled down, those "
    "smaller than min volume are counted apart.",
    "E335": "`--top N` is how many of the worst pairs PRE-IE looks at, with moments: a whole number, 0 for none.",
    "E336": "`--fos` is the factor of safety that pairs are held against, above 0: 1.3 or 1.5 are usual.",
    "E337": "Joints slide or topple nearly square to the face only; the lateral limit says how far off they still "
    "count, in degrees from its dip direction. 20 is usual for planar sliding, 10 to 30 for toppling; 90 leaves"
    " it out.",
    "E338": "Joints are the path of a CSV file, a list of planes, an array of dip and dip direction, or a dict of names"
    " and planes.",
    "E339": "In a list no joint is J1 or J2, so two values cannot be told apart. The columns c and phi of the list give"
    " each joint its own strength.",
    "W365": "Where moments govern, the closed form is too high: the PRE-IE limit is the number to use. Only the worst "
    "pairs are looked at by PRE-IE; `--top` takes more of them.",
    "W366": "Columns that slopekit does not know, rows without values, and with --skip-bad rows that are wrong: all are"
    " listed here, so that nothing is dropped silently.",
    "W367": "Kinematic tests know orientation and friction. Cohesion, water and size count in `slopekit combos`.",
    "W368": "Where the list gives joints their own friction angles, each is tested by its own. A line of intersection "
    "daylights into sliding at the lower angle of its two joints; columns topple obliquely within the highest "
    "of all.",
    "W369": "A face no steeper than the friction angle lets nothing slide that daylights in it; toppling is not "
    "excluded by that alone.",
    "E320": "Support is found for one block on one or two planes, where the closed form and PRE-IE can be held against "
    "each other. For other kinds give bolts in the design and let `slopekit solve` or `sweep` change their force.",
    "E321": "A number or a word of `slopekit support` lies outside what makes sense; the message names it. Directions "
    "are those of the bolts' force on the block, trend/plunge with the plunge positive downward: a bolt drilled level "
    "into a face that dips south has 000/00, drilled 10° upward 000/-10.",
    "E322": "Loads in this direction never give the target, however large: they drive as much as they press, lift the "
    "block off, or push it up the slope before. The message has the best they give. Leave --toward out for the best "
    "direction of all, or give --plunge for the best that can be drilled.",
    "E323": "A passive bolt pulls only where the movement draws it out, and no more than stops the movement along it. "
    "A bolt square to the movement, or one that the movement pushes in, adds little or nothing.",
    "E324": "Without cohesion and friction a load can only balance the block exactly; any other force moves it the one "
    "way or the other. Joints that are rough at all have friction: give it, then support has something to press on.",
    "E325": "A joint without contact has no cohesion, so that the factor of safety jumps where a force closes it. The "
    "target lies within the jump: the force given is where the factor is above it, and a little less leaves it below. "
    "Do not build on that edge: take more force, or drain the joint.",
    "E326": "A bolt is anchored behind a joint. From some places on the face, or in some directions, it leaves the "
    "block through a free face or the tension crack and holds nothing; `run` refuses such bolts too (E211).",
    "E327": "A bolt reaches from its head on the face through the block to the joint, and its anchorage lies behind "
    "that. `run` refuses a bolt that ends before (E212). Give the longest length, or leave --length out: each bolt is "
    "then listed with its own.",
    "E328": "The bolts of this capacity at this spacing cannot carry the force, or they are too many to be laid out. "
    "Give a larger --bolt-capacity or a smaller --spacing, or lower the force: drainage often does more than bolts.",
    "E329": "The closed form knows forces only. With the moments of the bolts and of the water the block turns at a "
    "lower factor, and no force in this direction that was tried lifts that to the target: PRE-IE's answer counts. "
    "Try another direction (--toward): square to the face turns the block least in many cases; PRESSURE says what "
    "that takes.",
    "E310": "The key is not among the numbers of this design, given or left to a default; the message names the "
    "nearest. A key is the path through the design file: strength.weak.phi, slope.face.dip, "
    "joints.J1.plane.dip_direction, water.fill, loads.seismic.k, support.bolts.0.force (the first bolt is 0).",
    "E311": "A study changes one number at a time. An orientation is two (slope.face.dip, slope.face.dip_direction), "
    "a group or a list has many, a text none. A number that counts something (node pairs, rows) can be swept "
    "but not solved for; a distribution is solved for by one of its own numbers: strength.weak.phi.mean.",
    "E312": "Values of a sweep are written KEY=from:to:how many, or KEY=a,b,c; a range for solve or a tornado "
    "KEY=lo:hi, the lower end first. All of them may carry units, but then each does: in 10:20ft nobody knows"
    " what the ten are.",
    "E313": "Some of what was asked for does not go together: no key or more than two, the same key twice, "
    "--closed-form for a kind of design without one, --seed without --pf.",
    "E314": "The target is a factor of safety between 1e-6 and 1e6, or with --pf a probability between 0 and 1 (5 % "
    "may be written 5%). Without one, solve takes the largest `fos >= ...` of the design's acceptance rules.",
    "E315": "No value in the range gives the target; the message says what is reached, and where. The range is what "
    "such a number can be in a slope, or the one you gave: KEY=lo:hi looks elsewhere.",
    "E316": "The factor is the same at every value that was tried. Friction of a joint that has lost contact, the "
    "weight of a wedge without cohesion or water, stiffness: none of them changes the limit.",
    "E317": "The factor passes the target in a jump, as where contact with a joint is lost and with it the cohesion "
    "(METHOD.md, section 3): just below the value it is above the target, just above it below, and nowhere "
    "equal.",
    "E318": "At every value that was tried the planes form no block, or the input is refused. The sheet lists the "
    "stretches with their reasons.",
    "E319": "The target lies between what two neighbouring values give, and in between the input is refused, or "
    "PRE-IE does not converge: friction angles between 0 and 1.57° are taken for radians, for example.",
    "W355": "The closed form knows forces only; where moments open part of a joint or turn the block, PRE-IE's factor"
    " lies below it, and its value is the one to use. Both are given, each put back.",
    "W356": "More than one value gives the target. The one nearest to the present value stands first; the others may "
    "be of another kind, such as a bolt so strong that it drives the block uphill.",
    "W357": "Put back, the value misses the target by more than 1e-9 (closed form) or 1e-6 (PRE-IE): the factor is so"
    " steep there that neighbouring floating-point numbers miss it, finer node pairs came in, or, of a "
    "probability, one sample more or less makes the step.",
    "W358": "Beside the value that was found, the factor also jumps across the target, or passes it where the input "
    "is refused: beyond that place the slope is on the other side of the target.",
    "E340": "`slopekit plot` draws the JSON that slopekit writes: result.json, sweep.json, prob.json and so on, or what"
    " --json printed into a file, or the folder with it. NaN and Infinity are no JSON. A file that ends in the middle "
    "was not written to the end: a full disk, a run that was stopped.",
    "E341": "The file is JSON, but slopekit did not write it, or what it holds are the faults of a run that failed.",
    "E342": "There is no picture of this name; the message has the nearest and what the file can give. `slopekit plot "
    "FILE` alone lists those.",
    "E343": "The file has no data for this picture: a histogram needs the samples of prob, a contour a sweep of two "
    "keys, factors and ravelling many blocks. The message names the command that writes such a file.",
    "E344": "The file lacks something that the picture needs, or has it in another form. Files of older versions of "
    "slopekit may: make the file again.",
    "E345": "Charts are written as .png, .svg or .pdf, scenes as .png, .glb or .gltf.",
    "E346": "--show needs a display and a toolkit that draws on it (PyQt, Tk). On a server write a file with -o.",
    "E347": "The option belongs to other pictures: --equal-angle to stereonets, --test to the stereonet of kinematic, "
    "--explode to exploded, --magnify to displacement and mechanism, --step to mechanism.",
    "W359": "Points that form no block, are refused, or have a status and no number stay in the sweep with their "
    "reason: they are counted here, listed in the sheet, and marked in the picture.",
}  # fmt: skip
