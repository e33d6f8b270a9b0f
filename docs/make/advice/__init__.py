"""The page on how much tether a scene needs, and the thresholds that the advisor reads."""
