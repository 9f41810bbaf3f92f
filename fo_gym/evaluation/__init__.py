"""From a compensator to a published row: episodes, metrics, statistics, reports."""
