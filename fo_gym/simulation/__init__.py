"""A batch of episodes: plant, hardware, control, reward; without Gymnasium."""
