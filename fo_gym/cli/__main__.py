"""`python -m fo_gym.cli` is `fo-gym`."""

from fo_gym.cli import app

if __name__ == "__main__":
    app()
