"""Whole-body control as pure functions: model terms, QP, balance and step planning.

Uses numpy, and a Drake plant for kinematics and dynamics. Diagrams, ports and messages
are in higher layers.
"""
