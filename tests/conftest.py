"""Every worker of the test run gets one thread: matrices are small, and the cores are the workers'.

Hypothesis mixes the constants of all loaded modules of the project into its examples: which ones it tries would then
depend on which tests ran before on the same worker. Here it does not see them.
"""

import os

from hypothesis.internal.conjecture import providers

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

if hasattr(providers, "_get_local_constants"):
    none_yet = providers._local_constants
    providers._get_local_constants = lambda: none_yet
