"""How close to the true torque each method of removing ripple comes: `make bench-accuracy`."""
