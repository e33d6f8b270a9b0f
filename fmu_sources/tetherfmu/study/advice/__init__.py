"""How much tether a scene needs: dimensionless numbers, thresholds, trade-off, advice, reports. Imports `measuring`."""
