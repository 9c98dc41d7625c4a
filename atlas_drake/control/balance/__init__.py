"""Balance: DCM, CoP, support polygon, weight shifts, step adjustment."""
