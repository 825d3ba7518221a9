"""Shear strength of joints: one law a file, arrays in, arrays out, kPa. `registry` lists them."""
