"""Before anyone bonds a gauge: how many, how carefully, and what a sensor made of them is worth."""
