"""What numba is told; set before the kernels are imported."""

#: Whether sums may be reordered and numbers that are none forgotten, which C++ is not told here.
fastmath = False
