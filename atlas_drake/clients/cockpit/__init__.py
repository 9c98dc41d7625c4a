"""The cockpit: a page in the browser that shows a run and commands it.

``operator`` has every control as a function, ``cockpit`` joins them to a simulation.
The page itself is in ``page``, which runs in a process of its own: no browser can hold
the simulation up.
"""
