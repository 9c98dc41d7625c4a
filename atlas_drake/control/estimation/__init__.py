"""State estimation: attitude and leg odometry."""
