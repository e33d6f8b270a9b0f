"""What all commands and examples share: their options, how they end, what they say meanwhile."""
