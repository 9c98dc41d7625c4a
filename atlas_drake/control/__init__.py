"""Whole-body control as pure functions: model terms, QP, balance and step planning.

Knows numpy and a Drake plant for kinematics; no diagram, no ports, no messages.
"""
