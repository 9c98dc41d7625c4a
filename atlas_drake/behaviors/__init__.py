"""What each behavior wants, tick by tick, and the rules for changing between them.

Plain Python on frozen values: no ports, no Context, no solver.
"""
