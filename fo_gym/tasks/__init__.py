"""Tasks: what a robot has to do, with which controller, and what varies from episode to episode."""
