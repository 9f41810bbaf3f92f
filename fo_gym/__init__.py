"""fo-gym: the benchmark for friction compensation on flexible robot joints.

Importing this package registers the environments with Gymnasium. What needs MuJoCo,
Numba or pandas is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from fo_gym.compensators import Compensator, CompensatorError, make_compensator
from fo_gym.envs.registry import ENVIRONMENTS
from fo_gym.friction import FRICTIONLESS, Dahl, ElastoPlastic, LuGre, MaxwellSlip
from fo_gym.hardware import Hardware, SensorModel
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, JointInfo, PDGains
from fo_gym.signals import Signals
from fo_gym.specs import list_compensators

__version__ = "0.2.0"

__all__ = [
    "ENVIRONMENTS",
    "FRICTIONLESS",
    "Compensator",
    "CompensatorError",
    "Dahl",
    "ElastoPlastic",
    "FlexibleJoint",
    "Hand",
    "Hardware",
    "ImpedanceGains",
    "JointInfo",
    "JointPath",
    "LuGre",
    "MaxwellSlip",
    "PDGains",
    "Push",
    "Randomization",
    "Robot",
    "SensorModel",
    "Settings",
    "Signals",
    "Step",
    "Task",
    "ToolHold",
    "ToolPath",
    "evaluate",
    "list_compensators",
    "make_compensator",
    "plot",
    "register",
    "sweep",
    "trace",
]

if TYPE_CHECKING:
    from fo_gym import plot
    from fo_gym.envs.registration import register
    from fo_gym.evaluation.results.sweep import sweep
    from fo_gym.evaluation.runs.evaluate import evaluate, trace
    from fo_gym.robots import Robot
    from fo_gym.simulation.settings import Settings
    from fo_gym.tasks.hand import Hand
    from fo_gym.tasks.joint_path import JointPath
    from fo_gym.tasks.randomization import Randomization
    from fo_gym.tasks.scenario import Push
    from fo_gym.tasks.step import Step
    from fo_gym.tasks.task import Task
    from fo_gym.tasks.tool_hold import ToolHold
    from fo_gym.tasks.tool_path import ToolPath
else:
    _LATER = {
        "Hand": "fo_gym.tasks.hand",
        "ToolHold": "fo_gym.tasks.tool_hold",
        "JointPath": "fo_gym.tasks.joint_path",
        "Push": "fo_gym.tasks.scenario",
        "Robot": "fo_gym.robots",
        "Step": "fo_gym.tasks.step",
        "Task": "fo_gym.tasks.task",
        "ToolPath": "fo_gym.tasks.tool_path",
        "register": "fo_gym.envs.registration",
        "Randomization": "fo_gym.tasks.randomization",
        "Settings": "fo_gym.simulation.settings",
        "evaluate": "fo_gym.evaluation.runs.evaluate",
        "sweep": "fo_gym.evaluation.results.sweep",
        "trace": "fo_gym.evaluation.runs.evaluate",
    }

    def __getattr__(name):
        if name == "plot":
            return import_module("fo_gym.plot")
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = getattr(import_module(_LATER[name]), name)
        return globals()[name]

    def __dir__():
        return sorted({*globals(), *__all__})
