"""fo-gym: the benchmark for friction compensation on flexible robot joints.

Importing this package registers FJRStiction-v0, FJRRegulation-v0 and FJRSquare-v0 with Gymnasium. What needs MuJoCo,
Numba or pandas is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from fo_gym.compensators import Compensator, CompensatorError, make_compensator
from fo_gym.envs.registry import ENVIRONMENTS
from fo_gym.hardware import Hardware, SensorModel
from fo_gym.parameters import FRICTIONLESS, FlexibleJoint, ImpedanceGains, JointInfo, LuGre, PDGains
from fo_gym.signals import Signals
from fo_gym.specs import list_compensators

__version__ = "0.1.0"

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
    from fo_gym.evaluation.results.sweep import sweep
    from fo_gym.evaluation.runs.evaluate import evaluate
    from fo_gym.simulation.settings import Settings
    from fo_gym.tasks.randomization import Randomization
else:
    _LATER = {
        "Randomization": "fo_gym.tasks.randomization",
        "Settings": "fo_gym.simulation.settings",
        "evaluate": "fo_gym.evaluation.runs.evaluate",
        "sweep": "fo_gym.evaluation.results.sweep",
    }

    def __getattr__(name):
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = getattr(import_module(_LATER[name]), name)
        return globals()[name]

    def __dir__():
        return sorted({*globals(), *__all__})
