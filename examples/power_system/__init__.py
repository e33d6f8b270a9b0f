"""How much power does a pumping kite give? Tether, kite, flight controller and winch as four FMUs."""
