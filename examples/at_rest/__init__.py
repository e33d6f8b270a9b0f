"""How does a tether hang at rest, and how hard does it pull?"""
