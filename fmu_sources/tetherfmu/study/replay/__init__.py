"""Measured flights: from the log of a flight to the forces on its tether, and how far to trust them."""
