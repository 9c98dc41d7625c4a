"""What people do with a simulation: a folder each, on the face of the spine."""
