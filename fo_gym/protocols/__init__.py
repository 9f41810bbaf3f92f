"""Protocols: what a leaderboard runs, as TOML files."""
