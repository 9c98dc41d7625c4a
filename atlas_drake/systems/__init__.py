"""LeafSystems: thin shells between ports and pure functions.

All state lives in the Context; the computations are in ``behaviors``, ``control`` and
``messages.commands``.
"""
