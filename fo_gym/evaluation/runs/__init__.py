"""Running episodes: sets of them, protocols, workers, the store, and running published ones again."""
