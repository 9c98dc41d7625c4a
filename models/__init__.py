"""Robot models: URDF files, their meshes and the script that generates both.

No simulation code lives here; the package reads the URDF files by path.
"""
