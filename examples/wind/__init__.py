"""Turbulent wind on a tether and its kite: a box of turbulence, and flights in it."""
