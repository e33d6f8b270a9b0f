"""Tether models for kites, cranes, moorings and drones: compiled functions on flat arrays, and shells around them."""

__version__ = "0.1.0"
