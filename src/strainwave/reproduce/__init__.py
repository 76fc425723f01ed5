"""Both papers, run again: every table and figure of theirs that has numbers, on simulated stations.

Taghirad & Belanger 1999 and Godler et al. 2000 each described an experiment; here the same
experiment is run on the simulated station of that paper through the product's own signal path.
"""
