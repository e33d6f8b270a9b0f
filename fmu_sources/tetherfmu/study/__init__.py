"""Studies of the tethers: what they cost. Nothing else imports this package."""
