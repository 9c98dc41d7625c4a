"""The behaviors, which command the QP in each tick, and the rules of their transitions.

Plain Python on frozen values: no ports, no Context, no solver.
"""
