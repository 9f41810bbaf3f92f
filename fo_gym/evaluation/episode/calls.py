"""Calls into a compensator, which may be anybody's code: what it does wrong is said by name."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real
from fo_gym.compensators import Compensator, CompensatorError, diagnostics_of, is_privileged
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.evaluation.episode.faults import EndedError, kind_of
from fo_gym.signals import Signals
from fo_gym.simulation.privileged import privileged_info

Array = NDArray[np.float64]

__all__ = ["checked_diagnostics", "checked_estimate", "checked_reset"]


def checked_reset(compensator: Compensator, name: str, env: JointVectorEnv) -> None:
    """Start the compensator on the current episodes of `env`. Raises CompensatorError for whatever it raises."""
    joints = privileged_info(env.simulation) if is_privileged(compensator) else env.joint_info
    try:
        compensator.reset(joints, env.num_envs)
    except EndedError as error:
        raise CompensatorError(f"{name}: reset: {error}") from error
    except (Exception, SystemExit) as error:
        raise CompensatorError(f"{name}: reset raised {kind_of(error)}: {error}") from error


def checked_estimate(
    compensator: Compensator, name: str, signals: Signals, alive: NDArray[np.bool_], tick: int
) -> Array:
    """The compensator's answer, checked where it counts: in the episodes that still run (`alive`).

    Raises:
        CompensatorError: it raised, or its answer is not a finite (num_envs, dof) array.
    """
    try:
        answer = real("estimate", compensator.estimate(signals))
    except EndedError as error:
        raise CompensatorError(f"{name}: estimate at tick {tick}: {error}") from error
    except (Exception, SystemExit) as error:
        raise CompensatorError(f"{name}: estimate raised {kind_of(error)} at tick {tick}: {error}") from error
    if answer.shape != signals.theta.shape:
        raise CompensatorError(
            f"{name}: estimate returned shape {answer.shape} at tick {tick}; (num_envs, dof) is {signals.theta.shape}"
        )
    bad = ~np.isfinite(answer).all(axis=1)
    if (bad & alive).any():
        i = int(np.flatnonzero(bad & alive)[0])
        raise CompensatorError(
            f"{name}: estimate returned {answer[i]} at tick {tick} in episode {i}; it must be finite"
        )
    return answer if alive.all() else np.where(alive[:, None], answer, 0.0)


def checked_diagnostics(compensator: Compensator, name: str, shape: tuple[int, ...], tick: int) -> Mapping[str, Array]:
    """What the compensator says of its last estimate.

    Raises:
        CompensatorError: it raised, or what it says is not a mapping of arrays of this shape, that of an estimate.
    """
    try:
        told = {str(part): real(str(part), value) for part, value in diagnostics_of(compensator).items()}
    except (Exception, SystemExit) as error:
        raise CompensatorError(f"{name}: diagnostics raised {kind_of(error)} at tick {tick}: {error}") from error
    for part, value in told.items():
        if value.shape != shape:
            raise CompensatorError(
                f"{name}: diagnostics[{part!r}] has shape {value.shape} at tick {tick}; (num_envs, dof) is {shape}"
            )
    return told
