"""Robots: link sides, what is designed for them, and what follows for control."""
