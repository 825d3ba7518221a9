"""One evaluation: columns of numbers of a design in, what both methods say of every row out."""

from slopekit.studies.evaluation.run import evaluate as evaluate
