"""How does a winch that is told a force hold a tension, and lift a load?"""
