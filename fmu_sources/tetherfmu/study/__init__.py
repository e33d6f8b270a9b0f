"""Studies of the tethers: what they cost, and how much tether a scene needs. Only the command `tetherfmu` and its page import it."""
