"""Forces on single columns that give a row of toppling columns a factor of safety."""

from slopekit.studies.support.columns.records import ColumnSupport

__all__ = ["ColumnSupport"]
