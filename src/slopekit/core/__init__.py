"""What every floor stands on: the sheet, and dataclasses as JSON."""
