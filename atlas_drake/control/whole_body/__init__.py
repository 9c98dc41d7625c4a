"""The whole-body QP: model terms, command, tasks, solver."""
