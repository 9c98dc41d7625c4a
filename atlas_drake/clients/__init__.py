"""What people do with a simulation: each folder imports the spine's face only."""
