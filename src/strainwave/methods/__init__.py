"""Ways of removing ripple from a recording, all behind one interface: for use and comparison."""
