"""How does a tether lie on the ground, and what does it take to drag it away?"""
