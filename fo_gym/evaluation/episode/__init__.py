"""An episode of a competitor: how it is recorded, and what it leaves behind."""
