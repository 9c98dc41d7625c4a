"""STAND and STAND_PREP, and the guard over the legs that every stance needs."""
