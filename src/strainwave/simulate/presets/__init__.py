"""Test stations after published experiments."""
