"""LeafSystems: thin shells between ports and the pure code below them.

All state lives in the Context; what is computed is in ``behaviors``, ``control`` and
``messages.commands``.
"""
