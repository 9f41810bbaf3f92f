"""The variants that every environment comes in; a module of its own, since whoever names one needs no simulation."""

VARIANTS = ("nominal", "randomized", "hardware")
"""No randomness; episodes drawn from the seed; the same with robots as they are."""

__all__ = ["VARIANTS"]
