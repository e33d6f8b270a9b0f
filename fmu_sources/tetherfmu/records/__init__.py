"""Constant records of users, with their checks: lines, points, winches, materials, paths."""
