"""The variants that every environment comes in; a module of its own, since whoever names one needs no simulation."""

NOMINAL = "nominal"
"""Without randomness: all seeds give the same episode; what seeds are for then says `fo_gym.evaluation.runs.cloud`."""

VARIANTS = (NOMINAL, "randomized", "hardware")
"""No randomness; episodes drawn from the seed; the same with robots as they are."""

__all__ = ["NOMINAL", "VARIANTS"]
