"""Robots: any MJCF or URDF file made into links, flexible joints, friction and a pose to start from."""

from fo_gym.robots.link_side import LinkSide
from fo_gym.robots.report import Line, Report
from fo_gym.robots.robot import Robot
from fo_gym.robots.shipped import RobotLike, robot_of, shipped_robots

__all__ = ["Line", "LinkSide", "Report", "Robot", "RobotLike", "robot_of", "shipped_robots"]
