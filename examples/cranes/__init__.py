"""How does a winch that is controlled by force hold a tension, and lift a load?"""
