"""Robot models: URDF files, their descriptions and meshes.

No code lives here; the package reads the files by path. ``tools`` generates them.
"""
