"""Both methods for many designs at once: a design with other numbers in each row.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> found = evaluate(wedge, {"water.fill": [0, 0.5, 1], "slope.face.dip": [60, 65, 70]})
>>> found.limit.words[0], found.limit.factor.round(4).tolist(), found.closed_form.factor.round(4).tolist()
('slides_on_both', [1.5574, 1.2811, 0.9863], [1.5574, 1.2826, 1.0284])
"""

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np

from slopekit.core.argument_checks import wrong_kind
from slopekit.core.errors import DesignError, Fault, Faults, fail
from slopekit.core.options import DESIGN, Option, documented
from slopekit.design.reading.files import design_from
from slopekit.studies.evaluation.columns import ColumnRows
from slopekit.studies.evaluation.rows import chosen_methods, evaluated
from slopekit.studies.keys import Key, key_of
from slopekit.studies.outcomes import Outcomes
from slopekit.studies.protocol import DESK, ClosedFormAlone, Jobs, Scheduler, Workplace
from slopekit.studies.running import checked_crew

_COLUMNS = Option(
    'Values by the path of a number, {"joints.J1.plane.dip": [44, 45], "water.fill": 0.5}: n of each or one for all '
    "rows, in the unit of bare numbers or texts with theirs; or a data frame with such columns."
)


@documented
def evaluate(
    design: Annotated[Any, DESIGN],
    columns: Annotated[Any, _COLUMNS],
    *,
    closed_form: ClosedFormAlone = False,
    jobs: Jobs = 1,
    scheduler: Scheduler = None,
    desk: Workplace = DESK,
) -> Outcomes:
    """Both methods for n designs: one with other numbers in each row.

    Returns
    -------
    Outcomes
        `limit` and `closed_form`, each with `words` (the status of every row, or the code of why it forms no block) and
        `factor` (n,), not a number where there is none; `difference`, `agree` (1, 0, -1 not compared),
        `moments_govern` (n,); `points`, the same row by row with notices and reasons.

    Raises
    ------
    DesignError
        E280 a design without a file, E310 and E311 for a path, E312 for the values, E313 for a design with load cases
        (`load(path, case=...)` takes one) or a closed form that there is none of, and those of `run_all`.

    Notes
    -----
    Rows of a wedge or a plane are taken all at once on arrays, where a few of them, analysed as designs of their own,
    say the same; other rows are read and analysed one after the other. No row is left out. What scatters and is no
    column is taken at its mean, as in a `sweep`; factors are those of the peak strength.

    Examples
    --------
    >>> import slopekit as sk
    >>> found = sk.evaluate("templates/wedge.yaml", {"slope.height": ["20 m", "30 m"]}, closed_form=True)
    >>> found.limit.factor.round(3).tolist()
    [2.535, 2.064]
    """
    crew, loaded = checked_crew(jobs, scheduler), design_from(design, "evaluate", "design")
    if loaded.cases:
        fail(
            "E313",
            f"the design has load cases ({', '.join(case.name for case in loaded.cases)}): rows are of one of them",
            "design",
            "Load it with one: load(path, case=NAME).",
        )
    chosen_methods(loaded, closed_form)
    keys, values, faults = list[Key](), list[Any](), Faults()
    paths = getattr(columns, "columns", columns)
    if isinstance(columns, str) or not isinstance(paths, Iterable):
        raise wrong_kind("evaluate", "columns", "values by the path of a number", columns)
    for path in paths:
        with faults.collecting():
            key = key_of(loaded, str(path))
            keys.append(key)
            values.append(_numbers(key, columns[path]))
    if len({key.path for key in keys}) < len(keys):
        faults.add(
            "E313", f"a number is given twice: {', '.join(key.path for key in keys)}", "columns"
        )
    faults.refuse()
    try:
        places = np.stack(np.broadcast_arrays(*values), axis=1)
    except ValueError:
        sizes = ", ".join(
            f"{key.path} {len(column)}" for key, column in zip(keys, values, strict=True)
        )
        message = f"columns have other numbers of values: {sizes or 'there are none'}"
        raise DesignError(
            [Fault("E312", message, "columns", "Give n values of each, or one for all rows.")]
        ) from None
    return evaluated(
        ColumnRows(loaded, keys, places, not closed_form),
        "evaluate",
        crew,
        desk,
        not closed_form,
        "rows",
    )


def _numbers(key: Key, column: Any) -> Any:
    """Return the values of a column (n,), or (1,) where one value holds for all rows."""
    numbers = np.atleast_1d(np.asarray(column))
    if numbers.dtype.kind in "iuf" and np.isfinite(numbers).all() and numbers.ndim == 1:
        return numbers.astype(np.float64)
    return np.array([key.read(value) for value in numbers.tolist()], dtype=np.float64)
