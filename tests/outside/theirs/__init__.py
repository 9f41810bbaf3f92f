"""A package of others that adds to fo-gym by entry points: a compensator, a command, a metric and an environment."""
