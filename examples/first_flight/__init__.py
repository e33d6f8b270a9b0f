"""Which forces does a tether put on a kite? A prescribed circle, and the shortest closed loop with a kite of your own."""
