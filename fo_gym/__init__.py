"""fo-gym: the benchmark for friction compensation on flexible robot joints.

Importing this package registers FJRStiction-v0, FJRRegulation-v0 and FJRSquare-v0 with Gymnasium. What needs MuJoCo,
Numba or pandas is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from gymnasium.envs.registration import register

from fo_gym.compensators import Compensator, CompensatorError, list_compensators, make_compensator
from fo_gym.hardware import Hardware, SensorModel
from fo_gym.parameters import FRICTIONLESS, FlexibleJoint, ImpedanceGains, JointInfo, LuGre, PDGains
from fo_gym.sensors import Signals

__version__ = "0.1.0"

ENVIRONMENTS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")
"""Ids of the registered environments."""

for _id, _entry in zip(ENVIRONMENTS, ("stiction:Stiction", "regulation:Regulation", "square:Square"), strict=True):
    # The environments truncate themselves at `duration`, so that `decimation` does not stretch time.
    register(id=_id, entry_point=f"fo_gym.envs.{_entry}Env", vector_entry_point=f"fo_gym.envs.{_entry}VectorEnv")

__all__ = [
    "ENVIRONMENTS",
    "FRICTIONLESS",
    "Compensator",
    "CompensatorError",
    "FlexibleJoint",
    "Hardware",
    "ImpedanceGains",
    "JointInfo",
    "LuGre",
    "PDGains",
    "Randomization",
    "SensorModel",
    "Settings",
    "Signals",
    "evaluate",
    "list_compensators",
    "make_compensator",
    "sweep",
]

if TYPE_CHECKING:
    from fo_gym.envs.settings import Settings
    from fo_gym.evaluation.evaluate import evaluate
    from fo_gym.evaluation.sweep import sweep
    from fo_gym.tasks.task import Randomization
else:
    _LATER = {
        "Randomization": "fo_gym.tasks.task",
        "Settings": "fo_gym.envs.settings",
        "evaluate": "fo_gym.evaluation.evaluate",
        "sweep": "fo_gym.evaluation.sweep",
    }

    def __getattr__(name):
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = getattr(import_module(_LATER[name]), name)
        return globals()[name]

    def __dir__():
        return sorted({*globals(), *__all__})
