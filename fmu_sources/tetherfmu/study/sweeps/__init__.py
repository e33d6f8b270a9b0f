"""Sweeps: one scene with many values, and statistics of each flight."""
