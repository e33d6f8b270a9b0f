"""Systems of tethers in one solver."""
