"""How fast the environments are, beside named peers that are timed in the same run: `fo-gym bench`."""
