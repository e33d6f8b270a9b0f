"""Systems of tethers: lines between points, moved in one step."""
