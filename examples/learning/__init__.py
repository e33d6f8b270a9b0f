"""How does a policy learn to steer a kite?"""
