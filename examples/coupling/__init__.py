"""How are a kite of finite mass and its tether coupled, and how long may a communication step be? docs/coupling.md."""
