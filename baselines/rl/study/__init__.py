"""How far the usual algorithms get on the environments as they are: `python -m baselines.rl.study`."""
