"""What a recording itself says about the joint."""
