"""A command, under the entry points `fo_gym.commands`."""

from fo_gym.console import say


def greet(name: str) -> None:
    """Say hello."""
    say(f"hello {name}")
