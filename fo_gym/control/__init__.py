"""Controllers and the nominal motor, batched over environments."""
