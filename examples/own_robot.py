"""A robot and a task of one's own: two hinges from an MJCF file, which step under gravity, as an environment.

python examples/own_robot.py
fo-gym evaluate pid-high --env examples/own_robot.py:TwoLinks-v0
"""

from pathlib import Path

import fo_gym

# Rotor inertias, torque limits and dry friction are the file's; springs and the rest are designed: print(robot.report).
robot = fo_gym.Robot.from_file(Path(__file__).parent / "arms/two_links.xml")

# Both joints step by 0.2 rad at once; the controller's gains are designed.
task = fo_gym.Task(fo_gym.Step(size=0.2), duration=5.0, reward_scale=1e-3)

# Not under `if __name__ == "__main__"`: worker processes import this file, too.
fo_gym.register("TwoLinks-v0", robot, task)

if __name__ == "__main__":
    for compensator in ("none", "pd-high", "pid-high"):
        rows = fo_gym.evaluate(compensator, "TwoLinks-v0")
        error = 1e3 * rows.steady_state_error_ju[0]
        print(f"{compensator:9s} FRR {rows.frr[0]:7.4f}   steady-state error {error:7.3f} mrad")
