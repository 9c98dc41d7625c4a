"""Gymnasium environments on the simulation, and the export of what is learned there.

``environment.AtlasEnv`` is any of them, ``tasks`` those that Gymnasium knows by name.
"""
