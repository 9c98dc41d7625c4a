"""Tests in a browser, which share it and one run."""
