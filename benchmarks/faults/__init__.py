"""Fault campaign: gauges of a simulated joint fail, and the sensor has to find which and go on."""
