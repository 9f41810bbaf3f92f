"""An environment, under the entry points `fo_gym.environments`: no arm, it keeps its own robot."""

import fo_gym

fo_gym.register("Theirs-v0", "single_link", fo_gym.Task(fo_gym.Step(size=5e-3), duration=0.2), tags=("link",))
