"""Scenes: flights of both ends, tethers and winds, from files, of the benchmark, or at random."""
