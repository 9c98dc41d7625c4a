"""A report of a robot that stands, for what plans by reports."""

from tests.planning.conftest import standing

__all__ = ["standing"]
