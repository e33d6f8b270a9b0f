"""Studies of the tethers: what they cost, and how much tether a scene needs. Nothing else imports this package."""
