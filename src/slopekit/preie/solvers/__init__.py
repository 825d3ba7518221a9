"""Systems of equations: stiffnesses factorised in the way that suits them, work counted."""
