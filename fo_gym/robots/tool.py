"""Which part of a robot is its tool: what the caller names, or the end of the longest chain."""

from __future__ import annotations

import mujoco
import numpy as np

from fo_gym.robots.survey import ancestors

_APART = 1e-3
"""How far [m] a body must be from the last joint's axis to count as away from it."""

__all__ = ["end_of_chain"]


def end_of_chain(whole: mujoco.MjModel, joints: tuple[str, ...]) -> tuple[str, str]:
    """Name of the site or body at the end of the longest chain of `joints`, and why it, for a report.

    The end is the last link and all that is fixed to it: its last site with a name, or the body farthest from the
    last joint's axis. Where several chains are equally long, such as fingers, it is the link that carries them all.
    """
    driven = [int(whole.joint(name).bodyid[0]) for name in joints]
    lengths = {body: sum(driven.count(above) for above in ancestors(whole, body)) for body in set(driven)}
    tips = sorted(body for body, length in lengths.items() if length == max(lengths.values()))
    common = [body for body in ancestors(whole, tips[0]) if all(body in ancestors(whole, tip) for tip in tips[1:])]
    carriers = [body for body in common if body in lengths]
    last = carriers[0] if carriers else tips[0]
    rigid = [body for body in range(1, whole.nbody) if _carrier(whole, body, driven) == last]
    sites = [site for site in range(whole.nsite) if int(whole.site_bodyid[site]) in rigid and whole.site(site).name]
    chain = f"the end of the longest chain ({lengths[last]} joints)"
    if sites:
        return whole.site(sites[-1]).name, f"site, the last at {chain}"
    data = mujoco.MjData(whole)
    mujoco.mj_kinematics(whole, data)
    joint = int(whole.body_jntadr[last] + whole.body_jntnum[last] - 1)
    away = data.xpos[rigid] - data.xanchor[joint]
    distance = np.linalg.norm(np.cross(away, data.xaxis[joint]), axis=1)
    far = np.linalg.norm(away, axis=1) + np.where(distance > _APART, 1e3, 0.0)
    return whole.body(rigid[int(np.argmax(np.round(far, 9)))]).name, f"body, at {chain}"


def _carrier(whole: mujoco.MjModel, body: int, driven: list[int]) -> int:
    """The next body towards the world that a driven joint moves; 0 for none."""
    return next((above for above in ancestors(whole, body) if above in driven), 0)
