"""Studies of the tethers: what they cost, and how much tether a scene needs. Only commands and the page `web` import it."""
