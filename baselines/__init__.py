"""Published friction compensators: one file per family, found through the entry points `fo_gym.compensators`."""

from baselines.eso import ExtendedStateObserver
from baselines.feedforward import FrictionFeedForward
from baselines.garofalo2019 import SuperTwistingObserver
from baselines.kaneko import KanekoObserver
from baselines.kim2019 import MeasuredPDObserver, MeasuredPIDObserver, PDObserver, PIDObserver
from baselines.kimchung2015 import KimChungObserver
from baselines.l1_observer import L1Observer
from baselines.letien2008 import LeTienObserver
from baselines.lugre1995 import LuGreObserver
from baselines.lugre_adaptive import AdaptiveLuGreObserver

__all__ = [
    "AdaptiveLuGreObserver",
    "ExtendedStateObserver",
    "FrictionFeedForward",
    "KanekoObserver",
    "KimChungObserver",
    "L1Observer",
    "LeTienObserver",
    "LuGreObserver",
    "MeasuredPDObserver",
    "MeasuredPIDObserver",
    "PDObserver",
    "PIDObserver",
    "SuperTwistingObserver",
]
