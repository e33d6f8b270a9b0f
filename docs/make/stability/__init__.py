"""The stability map: random tethers and flights from everyday to extreme, and a verdict on each. Imports `measuring`."""
