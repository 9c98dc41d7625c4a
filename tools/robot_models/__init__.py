"""Sources of the robot models: figures, shapes and the URDF writer.

Used by ``build_models.py`` and the tests only, never at run time.
"""
