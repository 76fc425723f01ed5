"""The methods that are compared, one file each, behind one small interface."""
