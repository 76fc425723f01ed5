"""Golden vectors: one set of samples and answers for host, Python and microcontroller."""
