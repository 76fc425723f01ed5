"""Peers in Python, each in a process of its own; what they need is in requirements-bench.lock."""
