"""A process of its own for every competitor that is not ours: it gets observations, gives estimates, and nothing else.

The suite's process holds the simulation, the references and the scores; `Guarded` stands there for the competitor.
`boot` is where the other process begins: it confines itself (`sandbox`) before it imports a stranger's code, and then
answers (`server`). docs/security.md says what this promises.
"""
