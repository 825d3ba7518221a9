"""PRE-IE: partitioned rigid elements and interface elements (Sheng, Li, Liu & Qi 2023), as arrays."""
