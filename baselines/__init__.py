"""Published friction compensators: one file per family, found through the entry points `fo_gym.compensators`."""

from baselines.kim2019 import PDObserver, PIDObserver
from baselines.letien2008 import LeTienObserver

__all__ = ["LeTienObserver", "PDObserver", "PIDObserver"]
