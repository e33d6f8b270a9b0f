"""Turbulent wind from files: boxes on a grid in space, which the mean wind carries past a tether."""
