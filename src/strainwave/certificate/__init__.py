"""Certificates of joints: what was found, by whom, with what, against which limits; and their check."""
