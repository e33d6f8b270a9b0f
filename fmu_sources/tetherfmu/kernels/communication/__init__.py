"""What every variant does with inputs, ends and outputs in a communication step. Imports `algebra` and `chain`."""
