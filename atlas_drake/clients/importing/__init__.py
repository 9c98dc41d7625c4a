"""Makes a robot of somebody's URDF: its YAML file, a URDF and meshes that Drake reads.

In the order of the work: ``source`` finds the file, ``tree`` reads it, ``anatomy``
finds limbs, ``repairs`` mends what cannot be, ``soles`` finds the feet's contact,
``meshes`` converts shapes, ``stand_prep`` and ``overlaps`` pose the robot, ``files``
writes, ``trial`` simulates and ``report`` shows. ``importer`` does all but the last
two.
"""
