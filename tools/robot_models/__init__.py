"""What the robot models are made of: figures, shapes and the URDF writer.

Only ``build_models.py`` and the tests use this; nothing at run time does.
"""
