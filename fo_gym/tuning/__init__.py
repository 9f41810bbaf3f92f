"""Equal tuning: the same search, with the same simulated time, for every compensator that declares its gains."""
