"""Index of each joint of the 28-joint Atlas in the arrays of a message.

For scripts that index arrays by name, as ``AtlasState.neck_ry``. They are the constants
of the robots ``atlas`` and ``atlas_v3`` only: any other robot has its own, in
``robot.joints``. The library itself takes the order from the description of the robot.
"""


class JointIndices:
    """Joint indices as class constants: the v3 names, and the v1 names as aliases."""

    __slots__ = ()

    back_bkz = 0
    back_bky = 1
    back_bkx = 2
    neck_ry = 3
    l_leg_hpz = 4
    l_leg_hpx = 5
    l_leg_hpy = 6
    l_leg_kny = 7
    l_leg_aky = 8
    l_leg_akx = 9
    r_leg_hpz = 10
    r_leg_hpx = 11
    r_leg_hpy = 12
    r_leg_kny = 13
    r_leg_aky = 14
    r_leg_akx = 15
    l_arm_shy = 16
    l_arm_shx = 17
    l_arm_ely = 18
    l_arm_elx = 19
    l_arm_wry = 20
    l_arm_wrx = 21
    r_arm_shy = 22
    r_arm_shx = 23
    r_arm_ely = 24
    r_arm_elx = 25
    r_arm_wry = 26
    r_arm_wrx = 27

    # The names of the first version. Knees, outer shoulders and elbows kept theirs.
    back_lbz = back_bkz
    back_mby = back_bky
    back_ubx = back_bkx
    neck_ay = neck_ry
    l_leg_uhz = l_leg_hpz
    l_leg_mhx = l_leg_hpx
    l_leg_lhy = l_leg_hpy
    l_leg_uay = l_leg_aky
    l_leg_lax = l_leg_akx
    r_leg_uhz = r_leg_hpz
    r_leg_mhx = r_leg_hpx
    r_leg_lhy = r_leg_hpy
    r_leg_uay = r_leg_aky
    r_leg_lax = r_leg_akx
    l_arm_usy = l_arm_shy
    l_arm_uwy = l_arm_wry
    l_arm_mwx = l_arm_wrx
    r_arm_usy = r_arm_shy
    r_arm_uwy = r_arm_wry
    r_arm_mwx = r_arm_wrx
