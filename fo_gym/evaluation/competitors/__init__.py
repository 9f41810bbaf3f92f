"""Who is scored: what is named, what it consists of, and the process that a stranger runs in."""
