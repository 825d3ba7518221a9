"""The long texts of the codes that design studies use: sampling, prob, sweep, solve, support, combos, kinematic."""

from collections.abc import Mapping

STUDIES: Mapping[str, str] = {
    "E280": "A study reads the design again with other values, so it needs the file, or the dict, that it came from. "
    "A wedge made by `sk.wedge(...)` has neither: write it as a design file or as a dict for `sk.load`.",
    "E300": "`--jobs N` works on N processes of this machine, `--scheduler` hands the work to a Dask cluster: one or "
    "the other. Results do not depend on either.",
    "E301": "Nothing answered at the address, or no worker is there. `dask scheduler` prints its address when it "
    "starts; each machine that shall work runs `dask worker` with that address and has slopekit installed.",
    "E303": "Worker processes were killed over the same tasks three times, without any being finished in between. Most "
    "often the system stops them for want of memory: fewer jobs, or smaller models. In a script of your own, studies "
    "with jobs have to be called below `if __name__ == '__main__':`, as for every pool of processes.",
    "E304": "The run was interrupted. The samples, points or pairs that were done stand in the journal; the same "
    "command finds them and goes on from there. A journal is of one run: with other inputs, another seed or another "
    "version of slopekit a run starts anew.",
    "E305": "Handing work to a cluster needs the library Dask: pip install 'slopekit[dask]'.",
    "E306": "Workers with another version of slopekit could give other numbers, and a worker without it none.",
}  # fmt: skip
