"""Hard cases: slopekit against a reference in 50 digits, along sweeps, at jumps and case by case (METHOD.md §7)."""
