"""How fast the filters are: beside peers, beside this machine's limit, in one run on the same data."""
