"""The plant: MuJoCo's rigid body, and our own step for motors, springs and friction."""

from fo_gym.plant.plant import FlexibleJointPlant
from fo_gym.plant.state import PlantState
from fo_gym.robots.log import keep_off_disk

keep_off_disk()

__all__ = ["FlexibleJointPlant", "PlantState"]
