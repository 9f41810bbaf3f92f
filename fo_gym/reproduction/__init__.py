"""Reproduce what arXiv:1907.00553 shows and says, and certify the physics: figures, claims, certificate."""
