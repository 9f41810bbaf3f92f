"""Films: competitors side by side, with what they do as curves below."""
