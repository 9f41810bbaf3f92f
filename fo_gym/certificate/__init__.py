"""Certify the physics: the plant held against SciPy on the equations, and against what else is known apart from it."""
