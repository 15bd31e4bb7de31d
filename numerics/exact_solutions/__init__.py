"""What the simulator must agree with."""
