"""The command line: one file per verb, options, output files, progress, the viewer.

No robotics: runs go through ``simulation``.
"""
